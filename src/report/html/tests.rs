//! Tests of whole pages.

use super::super::json::{Report, WaiverRow, WaiverState, WoAngles};
use super::super::plots::colours;
use super::super::plots::synthetic::gallery;
use super::super::saved::write_evidence;
use super::super::synthetic::report;
use super::page::page;
use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::comparison::{Change, Comparison, Origin, Place, What};
use crate::evidence::Figure;
use std::path::Path;

const HOSTILE: &str = "</script><script>x</script><!--\"' onload=\"x\" &amp; \u{202e}<img src=x>";

/// The page of a report without evidence.
fn of(report: &Report) -> String {
    page(Path::new("nowhere"), report)
}

/// Without the page's own script and style.
fn markup(page: &str) -> String {
    let mut text = String::new();
    let mut rest = page;
    for (begin, end) in [("<style ", "</style>"), ("<script nonce", "</script>")] {
        let (before, after) = rest.split_once(begin).unwrap();
        text.push_str(before);
        rest = after.split_once(end).unwrap().1;
    }
    text + rest
}

#[test]
fn failures_are_plain_and_passes_are_packed() {
    let page = of(&report());
    for part in [
        "1 of 3\u{a0}subjects failed",
        "<a href=\"#s-ggx-alpha-0.5-",
        "--goodness-of-fit\" title=\"goodness-of-fit: fail at all 2\u{a0}directions\"",
        "pdf() lacks the factor 1/(4 wo·h)",
        "divide by 4 wo·h",
        "812.0 nats behind",
        "href=\"#cause-half-vector-jacobian\"",
        "clearest at θo 60° φo 17°",
        "confirmed by a second run: p = 10^-60",
        "would only have seen an error of 5 %",
        "gonio check ggx:alpha=0.5 --theta 60 --phi 17 --seed 1",
        "<section class=\"subject pass packed\" id=\"s-lambert\"",
        "<td class=\"skipped\">–",
    ] {
        assert!(page.contains(part), "no {part}");
    }
    assert!(!page.contains("gonio check lambert"), "what passes is packed");
    assert_eq!(page, of(&report()), "the same report gives the same page");
}

#[test]
fn hostile_text_stays_text_everywhere() {
    let mut hostile = report();
    let text = || HOSTILE.to_string();
    hostile.suite = text();
    hostile.partial = Some(text());
    hostile.gonio = text();
    hostile.machine.os = text();
    for result in &mut hostile.results {
        result.subject.name = text();
        result.subject.label = Some(text());
        result.check = text();
        result.message = text();
        result.reason = Some(text());
        result.command = text();
        result.channel = Some(text());
        result.evidence = Some(text());
        result.plot = Some(text());
        result.waived_because = Some(text());
    }
    for found in &mut hostile.diagnoses {
        found.subject = text();
        found.cause = Some(text());
        found.statement = text();
        found.repair = Some(text());
        found.runner_up = Some(text());
        found.evidence = vec![text()];
        found.textbook = Some(text());
        found.page = Some(text());
    }
    hostile.waivers.push(WaiverRow {
        check: text(),
        subject: text(),
        because: text(),
        until: Some(text()),
        at_most: None,
        state: WaiverState::Expired,
        covered: 0,
    });
    let changed = Change {
        subject: text(),
        label: Some(text()),
        check: text(),
        what: What::Efficiency { before: Figure(0.5), after: Figure(0.4) },
        places: Vec::new(),
        cause: Some(text()),
        message: text(),
    };
    let before = Origin { suite: text(), started: text(), ..Origin::default() };
    hostile.comparison = Some(Comparison {
        before,
        worse: vec![changed],
        added: vec![text()],
        removed: vec![text()],
        ..Comparison::default()
    });
    let page = of(&hostile);
    let markup = markup(&page);
    for part in ["<script>x", "<img", "onload=\"", "<!--", "<svg"] {
        assert!(
            !markup.contains(part),
            "{part}: {}",
            &markup[markup.find(part).unwrap().saturating_sub(200)..]
        );
    }
    assert!(markup.matches("&#60;/script&#62;&#60;script&#62;x").count() > 20, "it is shown as it is");
}

#[test]
fn a_policy_lets_nothing_in_but_the_page_itself() {
    let page = of(&report());
    let nonce = page.split_once("script-src 'nonce-").unwrap().1.split('\'').next().unwrap();
    assert_eq!(nonce.len(), 32);
    assert_eq!(page.matches(&format!(" nonce=\"{nonce}\"")).count(), 2, "one style, one script");
    assert!(page.contains("default-src 'none'") && !page.contains("unsafe"));
    let other = Report { seed: 2, ..report() };
    assert!(!of(&other).contains(nonce), "another report has another");
    assert!(!markup(&page).contains(" style=\""), "the policy forbids styles of elements");
}

#[test]
fn what_is_not_complete_or_not_needed_is_told() {
    let mut report = report();
    report.partial = Some("it was interrupted after 3 of 9 cases".into());
    let waiver = |state| WaiverRow {
        check: "energy".into(),
        subject: "ggx".into(),
        because: "brighter on purpose".into(),
        until: Some("2026-01-02".into()),
        at_most: Some(0.02),
        state,
        covered: 1,
    };
    report.waivers = [WaiverState::Used, WaiverState::Unused, WaiverState::Expired, WaiverState::Exceeded]
        .map(waiver)
        .into();
    let page = of(&report);
    assert!(page.contains("<b>Not complete:</b> it was interrupted after 3 of 9 cases"));
    let table = page.split_once("<table class=\"waivers\">").unwrap().1.split("</table>").next().unwrap();
    let place = |word: &str| table.find(word).unwrap_or_else(|| panic!("no {word}"));
    assert!(
        place("unused: ") < place(">used<") && place("expired: ") < place(">used<"),
        "the used one is last"
    );
    assert!(table.contains("2.00 %") && table.contains("2026-01-02"));
}

#[test]
fn changes_are_told_and_marked() {
    let place =
        |theta_deg| Place { wo: Some(WoAngles { theta_deg, phi_deg: 17.0 }), transport: Transport::Radiance };
    let changed = |check: &str, what| Change {
        subject: "lambert".into(),
        label: None,
        check: check.into(),
        what,
        places: vec![place(30.0), place(60.0)],
        cause: None,
        message: String::new(),
    };
    let verdict = |before, after| What::Verdict { before: Some(before), after };
    let limit = What::DetectionLimit { before: Figure(0.01), after: Figure(0.02) };
    let comparison = Comparison {
        before: Origin { suite: "nightly".into(), seed: 7, ..Origin::default() },
        worse: vec![changed("white-furnace", limit)],
        better: vec![changed("goodness-of-fit", verdict(Verdict::Fail, Verdict::Pass))],
        removed: vec!["gone:alpha=1".into()],
        ..Comparison::default()
    };
    let page = of(&report().compared(Some(comparison)));
    for part in [
        "Compared with the report, suite nightly, seed 7",
        "1 worse, 1 better, 0 less sure",
        "What got worse",
        "<a href=\"#s-lambert--goodness-of-fit\"><bdi>lambert</bdi></a>",
        "<td>fail</td><td>pass</td>",
        "<td>1.00 %</td><td>2.00 %</td><td>θo 30° φo 17° and 1\u{a0}more direction</td>",
        "<td class=\"pass\"><a href=\"#s-lambert--goodness-of-fit\"",
        "<span class=\"trend better\" title=\"better than before\">",
        "<bdi>gone:alpha=1</bdi>",
        "name=\"changed\"",
    ] {
        assert!(page.contains(part), "no {part}");
    }
    assert!(!of(&report()).contains("name=\"changed\""));
}

#[test]
fn evidence_gives_cells_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let (_, evidence) = gallery().into_iter().find(|(name, _)| *name == "wrong").unwrap();
    let path = write_evidence(folder.path(), 3, &evidence).unwrap();
    let mut report = report();
    for result in report.results.iter_mut().filter(|r| r.verdict == Verdict::Fail) {
        result.evidence = Some(path.clone());
    }
    let drawn = page(folder.path(), &report);
    assert!(
        drawn.contains(
            "<script type=\"application/x-gonio-cells\" data-cells=\"evidence/case-0003.json.gz\">"
        )
    );
    assert!(drawn.contains("<noscript><figure class=\"picture stand-in\"><svg"));
    std::fs::write(folder.path().join(&path), "no gzip").unwrap();
    let damaged = page(folder.path(), &report);
    assert!(!damaged.contains("data-cells=\""));
    let told = "Not all evidence could be read: evidence/case-0003.json.gz is not a whole gzip file";
    assert!(damaged.contains(told) && !damaged.contains(&folder.path().display().to_string()));
}

#[test]
fn a_report_of_nothing_is_a_page() {
    let empty =
        Report { results: Vec::new(), diagnoses: Vec::new(), summary: Default::default(), ..report() };
    assert!(of(&empty).contains("Nothing was checked"));
}

fn linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// As WCAG 2 defines it.
fn contrast(a: colours::Rgb, b: colours::Rgb) -> f64 {
    let luminance = |rgb: colours::Rgb| {
        let [r, g, b] = rgb.map(|v| linear(f64::from(v) / 255.0));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// The two colours of `light-dark(…)` after `key` in the style.
fn of_style(key: &str) -> [colours::Rgb; 2] {
    let style = include_str!("style.css");
    let rest = style.split_once(key).unwrap_or_else(|| panic!("no {key}")).1;
    let pair = rest.split_once("light-dark(").unwrap().1.split(')').next().unwrap();
    let colours: Vec<colours::Rgb> = pair
        .split(", #")
        .map(|hex| {
            let hex = hex.trim_start_matches('#');
            [0, 2, 4].map(|k| u8::from_str_radix(&hex[k..k + 2], 16).unwrap())
        })
        .collect();
    colours.try_into().unwrap()
}

/// Pictures have the page's colours in both themes, and can be read in both.
#[test]
fn every_colour_of_pictures_has_a_dark_one() {
    let paper = of_style("--paper:");
    let hex = |[r, g, b]: colours::Rgb| format!("#{r:02x}{g:02x}{b:02x}");
    let texts = [colours::INK, colours::SOFT_INK].map(|c| (c, 4.5));
    let lines = colours::LINES.map(|c| (c, 3.0));
    for (colour, least) in texts.into_iter().chain(lines) {
        for of in ["fill", "stroke"] {
            let [light, dark] = of_style(&format!("svg [{of}=\"{}\" i]", hex(colour)));
            assert_eq!(light, colour, "the light theme changes nothing");
            assert!(contrast(light, paper[0]) >= least, "{of} {light:?}");
            assert!(contrast(dark, paper[1]) >= least, "{of} {dark:?}");
        }
    }
    assert_eq!(of_style(&format!("svg [fill=\"{}\" i]", hex(colours::PAPER))), paper);
    let [light, dark] = of_style(&format!("svg [fill=\"{}\" i]", hex(colours::BAND)));
    assert_eq!(light, colours::BAND);
    assert!(contrast(dark, of_style(&format!("svg [fill=\"{}\" i]", hex(colours::INK)))[1]) > 4.5);
}
