//! Grades made up for tests.

use crate::bsdf::Direction;
use crate::checks::{Effect, Verdict};
use crate::diagnosis::{Bin, Profile};
use crate::evidence::{Figure, Place};
use crate::grading::{Broken, GRADE_VERSION, Grade, Hints, Incident, ItemGrade, ItemKind, Lost, Phase};
use crate::report::{Diagnosis, Report, WoAngles, write_evidence};
use std::collections::BTreeMap;
use std::path::Path;

/// The hidden seed of examples.
pub const SEED: u64 = 8_231_977;

/// A text that tries everything.
pub const HOSTILE: &str = "</pre></script><script>x</script><!--\"' onload=\"x\" &amp; \u{202e}<img src=x> \
                           [l](javascript:x) `c` ```\n# head\n| a | b |\n{score}\u{1b}[31m";

/// A submission without items.
pub fn grade() -> Grade {
    Grade {
        grade_version: GRADE_VERSION,
        gonio: "0.1.0".into(),
        rubric: "Assignment 2: a rough metal".into(),
        id: "1042".into(),
        names: BTreeMap::from([("name".into(), "Ada Lovelace".into()), ("number".into(), "1042".into())]),
        language: Some("C++".into()),
        isolation: "wasm".into(),
        seed: SEED,
        hidden: true,
        broken: None,
        score: 0.0,
        max: 0.0,
        items: Vec::new(),
        diagnoses: Vec::new(),
        incidents: Vec::new(),
        review: Vec::new(),
    }
}

/// An item of which nothing was earned, with six cases of which three passed.
pub fn item(id: &str, points: f64) -> ItemGrade {
    ItemGrade {
        id: id.into(),
        title: format!("Title of {id}"),
        kind: ItemKind::Regular,
        hidden: false,
        points,
        earned: 0.0,
        cases: 6,
        passed: 3,
        unmet: None,
        loss: Some(format!("Text of {id}.")),
        hints: Hints::Cause,
        lost: Vec::new(),
    }
}

/// A hidden one that lost on this subject.
pub fn hidden_item(id: &str, subject: &str) -> ItemGrade {
    let found = Lost { message: "a hidden message".into(), ..lost(subject, "goodness-of-fit", 77.0) };
    ItemGrade { hidden: true, hints: Hints::Full, lost: vec![found], ..item(id, 2.0) }
}

/// A check that fails at φ = 17°.
pub fn lost(subject: &str, check: &str, theta_deg: f64) -> Lost {
    let wo = Direction::from_angles(theta_deg.to_radians(), 17f64.to_radians());
    let wi = Direction::from_angles(0.5, 3.4);
    Lost {
        subject: subject.into(),
        check: check.into(),
        wo: Some(WoAngles { theta_deg, phi_deg: 17.0 }),
        transport: Default::default(),
        verdict: Verdict::Fail,
        message: "∫pdf = 2.14, P(sample) = 0.95: no density integrates to more than 1".into(),
        effect: Some(Effect::interval("∫pdf / P(sample) − 1", (1.26, 1.25, 1.27), 0.001)),
        worst: Some(Place::pair(wo, wi).value("expected", 34.9825).value("observed", 858.0)),
        evidence: None,
    }
}

/// A diagnosis with counts at θ = 60°, φ = 17°.
pub fn diagnosis(subject: &str) -> Diagnosis {
    let bins = (0..12).map(|k| Bin { theta_deg: f64::from(7 * k), observed: 900.0, expected: 400.0 });
    Diagnosis {
        subject: subject.into(),
        cause: Some("half-vector-jacobian".into()),
        confident: true,
        statement: "pdf() lacks the Jacobian 1/(4 wo·h) of reflection about the half vector".into(),
        repair: Some("divide the density of h by 4 wo·h".into()),
        p_after_repair: Some(Figure(0.43)),
        runner_up: None,
        evidence: vec!["this holds at 426 of 426 directions to 1e-6".into()],
        textbook: Some("torrance-sparrow".into()),
        profile: Some(Profile {
            wo: Direction::from_angles(60f64.to_radians(), 17f64.to_radians()),
            bins: bins.collect(),
            predicted: vec![(0.0, 2.0), (80.0, 2.5)],
        }),
        plot: None,
        page: Some("docs/causes/half-vector-jacobian.md".into()),
    }
}

/// A report with the diagnoses of these subjects.
pub fn report(subjects: &[&str]) -> Report {
    let diagnoses = subjects.iter().map(|subject| diagnosis(subject)).collect();
    Report { diagnoses, results: Vec::new(), ..crate::report::synthetic::report() }
}

/// Writes evidence of a made-up lobe at θ = 60° or so; its path from the folder.
pub fn evidence_in(folder: &Path) -> String {
    use crate::report::lobes::{Lobe, evidence};
    let narrow = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
    let wide = Lobe { width: 0.4, cosine: 0.2, back: 0.0 };
    write_evidence(folder, 3, &evidence("metal", 60.0, 17.0, narrow, wide)).unwrap()
}

/// A submission with one of everything, its evidence at this path.
pub fn whole(evidence: &str) -> Grade {
    let found = |check: &str, theta| Lost {
        evidence: Some(evidence.into()),
        ..lost("metal:alpha=0.1", check, theta)
    };
    let items = vec![
        ItemGrade { earned: 1.0, cases: 0, passed: 0, loss: None, ..item("builds", 1.0) },
        ItemGrade {
            earned: 2.0 / 3.0,
            cases: 6,
            passed: 2,
            lost: vec![found("normalization", 30.0), found("normalization", 60.0), found("goodness-of-fit", 60.0)],
            loss: Some("Integrate your pdf over the hemisphere: it must give 1.\n\nSee chapter 3, and https://example.org/x_y.".into()),
            ..item("pdf", 2.0)
        },
        ItemGrade { earned: 3.0, passed: 6, ..item("values", 3.0) },
        ItemGrade { unmet: Some("pdf".into()), cases: 0, passed: 0, ..item("sampling", 2.0) },
        ItemGrade { kind: ItemKind::Bonus, hints: Hints::Full, lost: vec![found("mis", 60.0)], ..item("grazing", 1.0) },
        ItemGrade {
            kind: ItemKind::Penalty,
            earned: -0.5,
            hints: Hints::None,
            lost: vec![found("sanity", 60.0)],
            ..item("nan", 0.5)
        },
        hidden_item("secret", "metal:alpha=0.7734"),
    ];
    let score = items.iter().map(|i| i.earned).sum();
    let max = items.iter().filter(|i| i.kind == ItemKind::Regular).map(|i| i.points).sum();
    Grade {
        score,
        max,
        items,
        diagnoses: vec![
            diagnosis("metal:alpha=0.1"),
            Diagnosis { cause: Some("masking".into()), confident: false, ..diagnosis("metal:alpha=0.7734") },
        ],
        incidents: vec![Incident { phase: Phase::Run, what: "opened ../rubric.toml".into(), times: 3 }],
        review: vec!["albedo could not decide at θo 77°".into()],
        ..grade()
    }
}

/// One that does not build.
pub fn broken() -> Grade {
    let said = "brdf.cpp:3:1: error: unknown type name 'flaot'\n flaot pdf(vec3 wo);\n ^";
    Grade {
        id: "1043".into(),
        names: BTreeMap::from([("name".into(), "Ada Lovelace".into()), ("number".into(), "1043".into())]),
        broken: Some(Broken { why: "it does not build: clang++ ended with 1".into(), said: said.into() }),
        max: 3.0,
        items: vec![
            ItemGrade { cases: 0, passed: 0, ..item("builds", 1.0) },
            ItemGrade { passed: 0, unmet: Some("builds".into()), ..item("pdf", 2.0) },
        ],
        ..grade()
    }
}

/// One whose every text of its own is hostile.
pub fn hostile(evidence: &str) -> Grade {
    let text = || HOSTILE.to_string();
    let mut grade = whole(evidence);
    grade.id = text();
    grade.rubric = text();
    grade.names = BTreeMap::from([("name".into(), text()), (text(), "=1+1".into())]);
    grade.language = Some(text());
    grade.isolation = text();
    grade.broken = Some(Broken { why: text(), said: text() });
    grade.review = vec![text()];
    grade.incidents[0].what = text();
    for item in &mut grade.items {
        item.hints = Hints::Full;
        item.title = text();
        item.id = format!("{} {HOSTILE}", item.id);
        item.loss = Some(text());
        item.unmet = item.unmet.as_ref().map(|_| text());
        for lost in &mut item.lost {
            lost.subject = text();
            lost.check = text();
            lost.message = text();
            if let Some(effect) = &mut lost.effect {
                effect.name = text();
            }
            if let Some(worst) = &mut lost.worst {
                *worst = worst.clone().value(HOSTILE, 1.0);
            }
        }
    }
    for found in &mut grade.diagnoses {
        found.subject = text();
        found.cause = Some(text());
        found.statement = text();
        found.repair = Some(text());
        found.evidence = vec![text()];
    }
    grade
}
