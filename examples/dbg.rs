fn main() {
    let text = std::env::args().nth(1).unwrap();
    let theta = std::env::args().nth(2).unwrap_or("30.0,55.0,75.0".into());
    let registry = gonio::registry::Registry::builtin();
    let (name, rest) = text.split_once(':').unwrap_or((&text, ""));
    let mut s = format!(
        "[suite]\nname='x'\nsamples=65536\ndetect=1.0\ntheta=[{theta}]\nphi=[33.0]\n[[subject]]\nuse='{name}'\n"
    );
    for p in rest.split(',').filter(|p| !p.is_empty()) {
        let (k, v) = p.split_once('=').unwrap();
        if v.parse::<f64>().is_ok() {
            s += &format!("{k}={v}\n");
        } else {
            s += &format!("{k}='{v}'\n");
        }
    }
    let plan = gonio::suite::load("x", &s, &registry, &Default::default()).unwrap().plan;
    let r = gonio::engine::run(&plan, &Default::default(), &mut |_| {});
    let cases: Vec<_> = r.cases.iter().collect();
    let p = if std::env::var_os("NOPARAM").is_some() {
        Default::default()
    } else {
        cases[0].case.parameters.clone()
    };
    let t = std::time::Instant::now();
    let v = gonio::diagnosis::diagnose(&cases, &[], &p);
    println!("{:?}", v.map(|v| (v.cause(), v.confident, v.ranked.first().map(|r| r.1.statement.clone()))));
    println!("{:?} of {:.2}", t.elapsed(), r.cases.iter().map(|c| c.seconds).sum::<f64>());
}
