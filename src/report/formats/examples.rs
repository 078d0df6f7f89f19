//! Reports for tests: a usual one, and one whose every text tries to break out of its output.

use super::site::Site;
use crate::checks::Verdict;
use crate::report::json::Report;
use std::path::Path;

pub use crate::report::synthetic::report;

/// What formats give a meaning to.
pub const TEXT: &str = "</failure><injected a='1'>\"&amp;]]>\u{1b}[31m\u{1b}]0;\0\u{ffff}|`x```%0A%,::error::\n\
    ::set-output name=a::b\r\n# h <script>alert(1)</script> [a](https://evil.example) {0} \\ @a #1 *b* _c_ $x$ ~~d~~ \u{202e}";

/// Where they lie.
pub fn site() -> Site {
    Site::new(Path::new("/r"), Path::new("/r"), Path::new("out"))
}

/// All fields of text are that.
pub fn hostile() -> Report {
    let mut report = report();
    report.suite = TEXT.into();
    report.gonio = TEXT.into();
    report.started = TEXT.into();
    report.partial = Some(TEXT.into());
    let extra = [Verdict::Warn, Verdict::Error, Verdict::Waived].map(|verdict| {
        let mut result = report.results[2].clone();
        result.verdict = verdict;
        result
    });
    report.results.extend(extra);
    for result in &mut report.results {
        result.subject.name = TEXT.into();
        result.subject.label = Some(TEXT.into());
        result.check = format!("{} {TEXT}", result.check);
        result.message = TEXT.into();
        result.reason = Some(TEXT.into());
        result.command = format!("gonio check '{TEXT}'");
        result.channel = Some(TEXT.into());
        result.waived_because = Some(TEXT.into());
        if let Some(effect) = &mut result.effect {
            effect.name = TEXT.into();
        }
        if let Some(place) = &mut result.worst {
            *place = place.clone().value(TEXT, 1.0);
        }
    }
    for found in &mut report.diagnoses {
        found.subject = TEXT.into();
        found.cause = Some(TEXT.into());
        found.statement = TEXT.into();
        found.repair = Some(TEXT.into());
        found.runner_up = Some(TEXT.into());
        found.evidence = vec![TEXT.into()];
        found.textbook = Some(TEXT.into());
        found.page = Some(TEXT.into());
    }
    report
}
