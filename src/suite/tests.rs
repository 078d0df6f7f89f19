use super::*;
use crate::bsdf::{Bsdf, Description, Direction, Sample, Spectrum, Transport, TransportModes};
use crate::registry::{Model, Parameters, Registry, Role};
use std::collections::BTreeSet;

/// A subject that is never measured here: only its claims matter.
struct Glass(bool);

impl Bsdf for Glass {
    fn describe(&self) -> Description {
        Description::new("glass").claims(|c| {
            c.transmissive = self.0;
            c.transport = if self.0 { TransportModes::Both } else { TransportModes::Radiance };
        })
    }
    fn eval(&self, _: Direction, _: Direction, _: Transport) -> Spectrum {
        Spectrum::from(0.0)
    }
    fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
        0.0
    }
    fn sample(&self, _: Direction, _: &[f64], _: Transport) -> Option<Sample> {
        None
    }
}

fn refuses(p: &Parameters) -> Result<Glass, String> {
    let both = p.text("distribution") == "gaussian" && p.text("masking") == "smith";
    if both && p.text("sampling") == "visible-normals" {
        return Err("gaussian has no visible normals with smith".into());
    }
    Ok(Glass(false))
}

/// Stand-ins with the parameters of the models that come with gonio.
pub fn registry() -> Registry {
    let metals = ["aluminium", "gold", "silver", "copper"];
    let model = |name, transmissive| Model::new(name, "", move |_| Ok(Glass(transmissive)));
    let schlick = |m: Model, values: &[&str]| {
        m.number("f0", 0.9, 0.0..=1.0, "")
            .only_when("fresnel", &["schlick"])
            .choice("metal", &metals, "")
            .only_when("fresnel", values)
    };
    Registry::empty()
        .register(model("lambert", false).number("reflectance", 0.8, 0.0..=1.0, "").choice(
            "sampling",
            &["cosine", "uniform"],
            "",
        ))
        .register(model("oren-nayar", false).number("sigma", 20.0, 0.0..=90.0, "").number(
            "reflectance",
            0.8,
            0.0..=1.0,
            "",
        ))
        .register(model("dielectric", true).number("eta", 1.5, 1.0..=4.0, "").role(Role::Eta))
        .register(schlick(model("conductor", false).choice("fresnel", &["exact", "schlick"], ""), &["exact"]))
        .register(
            schlick(
                Model::new("torrance-sparrow", "", refuses)
                    .choice("distribution", &["ggx", "beckmann", "gaussian"], "")
                    .choice("masking", &["smith", "v-cavity"], "")
                    .choice("fresnel", &["none", "schlick", "dielectric", "conductor"], "")
                    .choice("sampling", &["visible-normals", "normals"], "")
                    .number("alpha", 0.3, 1e-4..=1.0, "")
                    .role(Role::Roughness)
                    .number("alpha_y", 0.0, 0.0..=1.0, ""),
                &["conductor"],
            )
            .number("eta", 1.5, 1.0..=4.0, "")
            .role(Role::Eta)
            .only_when("fresnel", &["dielectric"]),
        )
}

fn plan(text: &str) -> Plan<'static> {
    expanded(text).plan
}

fn expanded(text: &str) -> Expanded {
    load("test.toml", text, &registry(), &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.lines()))
}

fn mistakes(text: &str) -> Vec<String> {
    match load("test.toml", text, &registry(), &Overrides::default()) {
        Ok(_) => Vec::new(),
        Err(e) => e.lines(),
    }
}

/// Text, line of the mistake, and what its message must contain.
const MISTAKES: [(&str, usize, &[&str]); 36] = [
    ("[suite\nname = 1", 1, &["not TOML"]),
    ("[suite]\nseed = 1\nseed = 2", 3, &["not TOML", "duplicate"]),
    ("[suit]\nname = 'a'", 1, &["`suit`", "did you mean `suite`?"]),
    ("suite = 3", 1, &["[suite]", "a number"]),
    ("subject = 3", 1, &["[[subject]]", "a number"]),
    ("[suite]\nsample = 3", 2, &["`sample`", "did you mean `samples`?"]),
    ("[suite]\nsamples = 0", 2, &["at least 1 sample", "2^18"]),
    ("[suite]\nsamples = -5", 2, &["-5"]),
    ("[suite]\nsamples = true", 2, &["`samples` takes a whole number"]),
    ("[suite]\nsamples = '2^x'", 2, &["2^x", "is not a count"]),
    ("[suite]\nfalse_alarm = 1", 2, &["`false_alarm`", "between 0 and 1"]),
    ("[suite]\nfalse_alarm = nan", 2, &["NaN"]),
    ("[suite]\ntheta = [30,\n 181]", 3, &["181°", "0 to 180"]),
    ("[suite]\ntheta = [nan]", 2, &["NaN"]),
    ("[suite]\ntheta = []", 2, &["empty list"]),
    ("[suite]\nphi = [17, 17]", 2, &["lists 17 twice"]),
    ("[suite]\nphi = 'x'", 2, &["`phi` takes a number, not a string"]),
    ("[suite]\ncover = 'pair'", 2, &["`pair`", "did you mean `pairs`?"]),
    ("[suite]\nseed = -1", 2, &["-1"]),
    ("[suite]\ntime_limit = 0", 2, &["not a time"]),
    ("[suite]\nchecks = ['suport']", 2, &["no check", "did you mean `support`?"]),
    ("[[subject]]\nreflectance = 1", 1, &["without `use`"]),
    ("[[subject]]\nuse = 'lambart'", 2, &["no subject is called `lambart`", "did you mean `lambert`?"]),
    ("[[subject]]\nuse = 'lambert'\nreflectence = 1", 3, &["`reflectence`", "did you mean `reflectance`?"]),
    ("[[subject]]\nuse = 'lambert'\nclams = { lossless = true }", 3, &["`clams`", "did you mean `claims`?"]),
    ("[[subject]]\nuse = 'lambert'\nreflectance = [0.5,\n 1.5]", 4, &["1.5", "did you mean `1`?"]),
    ("[[subject]]\nuse = 'lambert'\nsampling = 'cosin'", 3, &["`cosin`", "did you mean `cosine`?"]),
    ("[[subject]]\nuse = 'lambert'\nreflectance = []", 3, &["empty list"]),
    ("[[subject]]\nuse = 'lambert'\nclaims = { loss = true }", 3, &["`loss`", "did you mean `lossless`?"]),
    ("[[subject]]\nuse = 'lambert'\nclaims = { lossless = 'x' }", 3, &["`lossless` cannot be \"x\""]),
    ("[[subject]]\nuse = 'lambert'\nwaive = [{ check = 'mis' }]", 3, &["without `because`"]),
    ("[[subject]]\nshader = 'a.wgsl'", 2, &["`shader`", "not supported by this version"]),
    ("[[subject]]\nprocess = ['no-such-program', 'a.py']", 2, &["`no-such-program`", "PATH"]),
    ("[[subject]]\nlibrary = 'a.so'", 2, &["`a.so` does not exist", "folder of the suite"]),
    ("[suite]\nmemory = 1", 2, &["1 MiB", "4096"]),
    ("[[subject]]\nuse = 'lambert'\nreference = 'lambert:x'", 3, &["not KEY=VALUE"]),
];

#[test]
fn mistakes_name_their_line_and_what_to_type() {
    let mut wrong = Vec::new();
    for (text, line, parts) in MISTAKES {
        let found = mistakes(text);
        let right = |one: &String| {
            one.starts_with(&format!("{line}: ")) && parts.iter().all(|part| one.contains(part))
        };
        if found.len() != 1 || !right(&found[0]) {
            wrong.push((text, line, parts, found));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn all_mistakes_are_told_at_once_with_the_text() {
    let text = "[suite]\nsampels = 3\n[[subject]]\nuse = 'lambart'\n[[subject]]\nuse = 'lambert'\nalfa = 1\n";
    assert_eq!(mistakes(text).len(), 3);
    let error = load("my.toml", text, &registry(), &Overrides::default()).err().unwrap();
    let mut page = String::new();
    miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor())
        .render_report(&mut page, &error)
        .unwrap();
    for part in
        ["my.toml has 3 mistakes", "my.toml:2:1", "sampels = 3", "my.toml:4:7", "did you mean `samples`?"]
    {
        assert!(page.contains(part), "{page}");
    }
}

#[test]
fn labels_are_given_once() {
    let text = "[[subject]]\nuse='lambert'\nlabel='a'\n[[subject]]\nuse='lambert'\nlabel='a'";
    assert!(mistakes(text)[0].starts_with("6: another subject is labelled `a`"));
}

#[test]
fn a_suite_without_subjects_has_no_case() {
    let plan = plan("");
    assert!(plan.cases.is_empty());
    assert_eq!((plan.suite.as_str(), plan.seed, plan.false_alarm), ("test", 1, 1e-6));
}

#[test]
fn lists_and_directions_multiply() {
    let cases =
        plan("[[subject]]\nuse='lambert'\nreflectance=[0.2,0.5]\nsampling=['cosine','uniform']").cases;
    assert_eq!(cases.len(), 2 * 2 * 6 * 3);
    assert_eq!(cases[0].label(), "lambert:reflectance=0.2 θ=0° φ=17°");
    assert_eq!(cases.last().unwrap().label(), "lambert:reflectance=0.5,sampling=uniform θ=89° φ=257°");
}

#[test]
fn two_sides_and_both_modes_are_measured_where_they_exist() {
    let cases = plan("[suite]\ntheta=[30,90]\nphi=17\n[[subject]]\nuse='dielectric'").cases;
    let found: Vec<_> = cases.iter().map(|c| (c.transport, c.theta_deg)).collect();
    let (r, i) = (Transport::Radiance, Transport::Importance);
    assert_eq!(found, [(r, 30.0), (r, 150.0), (r, 90.0), (i, 30.0), (i, 150.0), (i, 90.0)]);
    let one = plan(
        "[suite]\ntheta=30\nphi=17\n[[subject]]\nuse='dielectric'\nclaims={transmissive=false,transport='radiance'}",
    );
    assert_eq!(one.cases.len(), 1);
}

#[test]
fn refused_combinations_are_left_out_and_counted() {
    let text = "[suite]\ntheta=30\nphi=17\n[[subject]]\nuse='torrance-sparrow'\ndistribution=['ggx','gaussian']\nsampling=['visible-normals','normals']";
    let found = expanded(text);
    assert_eq!((found.plan.cases.len(), found.refused), (3, 1));
    let none = "[[subject]]\nuse='torrance-sparrow'\ndistribution='gaussian'";
    assert!(mistakes(none)[0].contains("2: `torrance-sparrow` cannot be built"), "{:?}", mistakes(none));
}

#[test]
fn parameters_that_do_not_apply_make_no_cases() {
    let text = "[suite]\ntheta=30\nphi=17\n[[subject]]\nuse='conductor'\nfresnel=['exact','schlick']\nf0=[0.1,0.2]\nmetal=['gold','silver']";
    let names: Vec<_> = plan(text).cases.iter().map(|c| c.spelling.clone()).collect();
    let expected = [
        "conductor:metal=gold",
        "conductor:metal=silver",
        "conductor:fresnel=schlick,f0=0.1",
        "conductor:fresnel=schlick,f0=0.2",
    ];
    assert_eq!(names, expected);
}

#[test]
fn pairs_cover_every_two_values_that_can_meet() {
    let head = "theta=[0,60,85]\nphi=[17,137]\n";
    let tail = "[[subject]]\nuse='torrance-sparrow'\ndistribution=['ggx','gaussian']\nmasking=['smith','v-cavity']\nsampling=['visible-normals','normals']\nalpha=[0.1,0.5,1]";
    let all = plan(&format!("[suite]\n{head}{tail}")).cases;
    let few = plan(&format!("[suite]\ncover='pairs'\n{head}{tail}")).cases;
    let pairs = |cases: &[std::sync::Arc<Case>]| {
        let mut found = BTreeSet::new();
        for case in cases {
            let mut values: Vec<String> = case.parameters.0.iter().map(|(k, v)| format!("{k}={v}")).collect();
            values.extend([format!("θ={}", case.theta_deg), format!("φ={}", case.phi_deg)]);
            for a in &values {
                found.extend(values.iter().map(|b| (a.clone(), b.clone())));
            }
        }
        found
    };
    assert_eq!(pairs(&all), pairs(&few));
    assert!(few.len() < 15 && all.len() == 126, "{} of {}", few.len(), all.len());
}

#[test]
fn overrides_take_the_place_of_what_is_written() {
    let text = "[suite]\nseed=3\n[[subject]]\nuse='dielectric'\nphi=[1,2]\nsamples=7";
    let overrides = Overrides {
        seed: Some(9),
        samples: Some(64),
        theta: vec![40.0],
        phi: vec![5.0],
        checks: vec!["mis".into()],
        ..Overrides::default()
    };
    let plan = load("t", text, &registry(), &overrides).ok().unwrap().plan;
    // One mode of transport each; no other side where θ is asked for.
    assert_eq!((plan.seed, plan.cases.len()), (9, 2));
    let case = &plan.cases[0];
    assert_eq!((case.theta_deg, case.phi_deg, case.settings.samples), (40.0, 5.0, 64));
    assert_eq!(case.checks, ["mis"]);
}

#[test]
fn variants_change_what_applies_and_go_to_limits() {
    let text = "[suite]\ntheta=30\nphi=17\n[[subject]]\nuse='torrance-sparrow'\nalpha=0.2\nfresnel='dielectric'\nreference='lambert'";
    let plan = plan(text);
    let company = &plan.cases[0].company;
    let found: Vec<_> =
        company.variants.iter().map(|v| (v.parameter.as_str(), v.to.as_str(), v.limit)).collect();
    for expected in [
        ("alpha", "0.6000000000000001", None),
        ("alpha", "0.0001", Some(Role::Roughness)),
        ("eta", "1", Some(Role::Eta)),
        ("fresnel", "none", None),
    ] {
        assert!(found.contains(&expected), "{found:?} lacks {expected:?}");
    }
    // Neither is used by this Fresnel term.
    assert!(found.iter().all(|(name, ..)| !["f0", "metal"].contains(name)), "{found:?}");
    assert_eq!(found.iter().filter(|(name, ..)| *name == "alpha_y").count(), 2);
    assert_eq!(plan.cases[0].reference.as_deref(), Some("lambert"));
}

#[test]
fn embedded_suites_expand_to_the_size_they_are_meant_to_have() {
    let registry = Registry::builtin();
    for (suite, sizes) in EMBEDDED.iter().zip([300..=400, 30..=70, 3000..=20_000]) {
        SuiteFile::parse(suite.name, suite.text).unwrap_or_else(|e| panic!("{:#?}", e.lines()));
        let found = load(suite.name, suite.text, &registry, &Overrides::default());
        let plan = found.unwrap_or_else(|e| panic!("{}: {:#?}", suite.name, e.lines())).plan;
        assert_eq!(plan.suite, suite.name);
        println!("{}: {} cases", suite.name, plan.cases.len());
        assert!(sizes.contains(&plan.cases.len()), "{}: {} cases", suite.name, plan.cases.len());
        let again = load(suite.name, suite.text, &registry, &Overrides::default()).ok().unwrap().plan;
        assert!(plan.cases.iter().zip(&again.cases).all(|(a, b)| a.label() == b.label()));
    }
}
