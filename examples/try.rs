use gonio::bsdf::*;
use gonio::engine::*;
use gonio::suite::*;
use std::sync::Arc;
#[path = "../tests/common/mod.rs"]
mod common;
use common::*;
fn main() {
    let mut cases = vec![];
    let a: Vec<f64> = std::env::args().skip(2).map(|s| s.parse().unwrap()).collect();
    let bug = match std::env::args().nth(1).unwrap().as_str() {
        "none" => Bug::None,
        "alpha" => Bug::PdfAlpha(0.01),
        "jac" => Bug::PdfJacobian,
        "redraw" => Bug::Redraw,
        "wcos" => Bug::WeightCosine,
        "fres" => Bug::FresnelAtNormal,
        "dcos" => Bug::CosineInD,
        "ucos" => Bug::UndeclaredCosine,
        "stray" => Bug::Stray(1e-4),
        "mir" => Bug::MirroredShare(0.01),
        "hv" => Bug::HalfVector,
        "ph" => Bug::PhantomBack,
        _ => panic!(),
    };
    for alpha in &a {
        for (t, ph) in [(0., 17.), (30., 137.), (60., 257.), (75., 17.), (85., 137.), (89., 257.)] {
            let subject = Arc::new(Ggx::new(*alpha, bug));
            cases.push(Arc::new(Case {
                group: "ggx".into(),
                spelling: format!("ggx:alpha={alpha}"),
                subject,
                parameters: Default::default(),
                theta_deg: t,
                phi_deg: ph,
                transport: Transport::Radiance,
                claims: Default::default(),
                waivers: vec![],
                company: Default::default(),
                reference: None,
                checks: vec![],
                settings: Settings { samples: 1 << 20, ..Default::default() },
            }));
        }
    }
    let plan = Plan { suite: "try".into(), seed: 1, false_alarm: 1e-6, share: None, cases };
    let r = run(&plan, &Options::default(), &mut |_| {});
    for c in &r.cases {
        println!(
            "== {} {:.3}s {:?} Z={:?} cells={} ",
            c.case.label(),
            c.seconds,
            c.evidence.as_ref().map(|e| (e.evaluations, e.halts.clone())),
            c.evidence.as_ref().and_then(|e| e.integrals.as_ref()).map(|i| (
                i.mass(),
                i.evaluations,
                i.cross_check,
                i.converged
            )),
            c.evidence.as_ref().and_then(|e| e.partition.as_ref()).map_or(0, |p| p.len())
        );
        for f in &c.findings {
            println!(
                "   {:16} {:12} {} {:?} {:?}",
                f.check,
                f.outcome.verdict.word(),
                f.outcome.message,
                f.outcome.detection_limit,
                f.attempts.iter().map(|a| (a.samples, a.ln_p)).collect::<Vec<_>>()
            );
        }
    }
    println!("{:.3}s share {:e} tests {} {:?}", r.seconds, r.share, r.tests, r.partial);
}
