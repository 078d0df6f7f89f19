use gonio::diagnosis::*;
fn main() {
    let registry = gonio::registry::Registry::builtin();
    let s = "[suite]\nname='x'\nsamples=65536\ndetect=1.0\ntheta=[30.0]\nphi=[33.0]\n[[subject]]\nuse='mutant-phong-exponent'\nexponent=17.97\n";
    let plan = gonio::suite::load("x", s, &registry, &Default::default()).unwrap().plan;
    let r = gonio::engine::run(&plan, &Default::default(), &mut |_| {});
    let e = r.cases[0].evidence.as_ref().unwrap();
    let m = registry.model("phong").unwrap();
    let subject = r.cases[0].case.subject.clone();
    let c = Counts::of(e, |wi| {
        let mut out = vec![0.0; wi.len()];
        subject.pdf(e.wo, wi, e.transport, &mut out).unwrap();
        out
    })
    .unwrap();
    println!("{:?}", r.cases[0].case.parameters);
    for k in 0..20 {
        let n = 17.0 + 0.2 * k as f64;
        let p = m
            .complete(&[("kd".into(), 0.0.into()), ("ks".into(), 1.0.into()), ("exponent".into(), n.into())])
            .unwrap();
        let book = Textbook::new("phong", &p).unwrap();
        let mm = c.masses(|wi| book.pdf(e.wo, wi));
        println!("{n:.2} {:.1} {:?}", c.test(&mm, 0).x2(), mm.iter().filter(|m| m.is_finite()).sum::<f64>());
    }
}
