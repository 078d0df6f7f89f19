//! Measured files made from analytic models: their bytes are those of the
//! format, reading them gives the model back, and every check that they claim
//! passes; a file or a reader that is wrong in one way is found by the check
//! whose identity that breaks.

mod common;

use common::measuring::{self, measure};
use gonio::bsdf::{Description, Direction, Samples, Spectrum, Subject, SubjectError, Transport};
use gonio::checks::Verdict;
use gonio::engine::CaseResult;
use gonio::measured::{HalfDifference, Interpolation, MerlTable, Reading, Resolution, Rgl, read};
use gonio::registry::Registry;
use gonio::suite::Case;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::{Arc, OnceLock};

const GLOSSY: &str = "torrance-sparrow:alpha=0.2,fresnel=conductor";
const DIFFUSE: &str = "oren-nayar";

fn model(name: &str) -> Arc<dyn Subject> {
    Registry::builtin().resolve(&name.parse().unwrap()).unwrap().subject
}

/// f of a model in three channels.
fn value(subject: &dyn Subject, wo: Direction, wi: Direction) -> [f64; 3] {
    let own = subject.describe().channels.len();
    let mut out = vec![0.0; own];
    subject.eval(wo, &[wi], Transport::Radiance, &mut out).unwrap();
    [0, 1, 2].map(|c| out[c.min(own - 1)])
}

fn merl(name: &str) -> Vec<u8> {
    let subject = model(name);
    MerlTable::bake(|wo, wi| value(&*subject, wo, wi))
}

/// The glossy file, which many tests read.
fn glossy() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| merl(GLOSSY))
}

fn rgl(name: &str, alpha: f64, resolution: &Resolution) -> Vec<u8> {
    let subject = model(name);
    Rgl::bake(name, &[], alpha, resolution, |wo, wi| Spectrum::from(&value(&*subject, wo, wi)[..]))
}

fn nearest_reading() -> Reading {
    Reading { interpolation: Interpolation::Nearest, ..Reading::default() }
}

fn opened(bytes: &[u8]) -> Arc<dyn Subject> {
    read(bytes, &Reading::default()).unwrap()
}

fn case(name: &str, subject: Arc<dyn Subject>, theta: f64, checks: &[&str]) -> Case<'static> {
    let checks = checks.iter().map(|c| (*c).to_string()).collect();
    Case { checks, ..measuring::case(name, subject, theta, 1 << 17) }
}

/// Each finding with this verdict, and what it said.
fn told(results: &[CaseResult], verdict: Verdict) -> Vec<String> {
    let findings = results.iter().flat_map(|r| r.findings.iter().map(move |f| (r, f)));
    findings
        .filter(|(_, f)| f.outcome.verdict == verdict)
        .map(|(r, f)| format!("{} {}: {}", r.case.label(), f.check, f.outcome.message))
        .collect()
}

const THETA: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];

#[test]
fn correct_files_pass_every_check_that_they_claim() {
    let files = [
        ("merl glossy", opened(glossy())),
        ("merl nearest", read(glossy(), &nearest_reading()).unwrap()),
        ("merl diffuse", opened(&merl(DIFFUSE))),
        ("rgl glossy", opened(&rgl(GLOSSY, 0.2, &Resolution::default()))),
        ("rgl diffuse", opened(&rgl(DIFFUSE, 0.8, &Resolution::default()))),
    ];
    let cases = files.iter().flat_map(|(name, s)| THETA.map(|theta| case(name, s.clone(), theta, &[])));
    let results = measure(cases.collect());
    for verdict in [Verdict::Fail, Verdict::Error, Verdict::Inconclusive, Verdict::Warn] {
        assert_eq!(told(&results, verdict), [""; 0]);
    }
    let skipped = told(&results, Verdict::Skipped);
    let sure = skipped.iter().find(|s| s.contains("merl glossy") && s.contains("reciprocity"));
    assert!(sure.is_some_and(|s| s.contains("cannot fail by construction: the table")), "{skipped:?}");
}

/// The format's documentation is its own reader's: three i32, then planes of f64
/// for red, green and blue, whose index is φd + 180 (θd + 90 θh), with θh divided
/// by a square root, times 1/1500, 1.15/1500 and 1.66/1500.
#[test]
fn merl_bytes_are_those_of_the_format() {
    let bytes = MerlTable::bake(|wo, wi| {
        let angles = HalfDifference::new(wo, wi);
        [angles.theta_h + 1.0, angles.theta_d + 1.0, angles.phi_d + 1.0]
    });
    assert_eq!(bytes.len(), 12 + 90 * 90 * 180 * 3 * 8);
    assert_eq!(bytes[..12], [90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0]);
    for [i, j, k] in [[0usize, 0usize, 0usize], [0, 3, 179], [20, 10, 45], [45, 30, 90], [60, 12, 100]] {
        let expected = [
            ((i as f64 + 0.5) / 90.0).powi(2) * FRAC_PI_2,
            (j as f64 + 0.5) / 90.0 * FRAC_PI_2,
            (k as f64 + 0.5) / 180.0 * PI,
        ];
        for (c, scale) in [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0].into_iter().enumerate() {
            let at = 12 + 8 * (k + 180 * (j + 90 * i) + c * 90 * 90 * 180);
            let stored = f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
            let (found, expected) = (stored * scale, expected[c] + 1.0);
            assert!((found - expected).abs() < 1e-9, "{i} {j} {k} channel {c}: {found}, not {expected}");
        }
    }
    // The steepest half vectors with the widest differences are below the horizon.
    let last = f64::from_le_bytes(bytes[bytes.len() - 8..].try_into().unwrap());
    assert!(last < 0.0);
}

/// Largest relative difference between a table and its model, and its root mean
/// square, over directions well above the horizon.
fn difference(table: &dyn Subject, name: &str, most: f64) -> [f64; 2] {
    let subject = model(name);
    let (mut largest, mut squares) = (0.0f64, 0.0);
    for k in 0..2000 {
        let at = |a: f64| (a * f64::from(k)).fract();
        let wo = Direction::from_angles(most * at(0.618_034), 6.0 * at(0.414_214));
        let wi = Direction::from_angles(most * at(0.732_051), 6.0 * at(0.236_068));
        let (a, b) = (value(table, wo, wi), value(&*subject, wo, wi));
        for c in 0..3 {
            let off = (a[c] / b[c] - 1.0).abs();
            largest = largest.max(off);
            squares += off * off / 6000.0;
        }
    }
    [largest, f64::sqrt(squares)]
}

#[test]
fn files_reproduce_their_model_within_their_resolution() {
    // MERL's cells are 1° wide in θd and φd; θh's are 2° at 60°. In RGL's polar
    // coordinates the first patch of 64 is 11° wide where D is.
    let nearest = read(glossy(), &nearest_reading()).unwrap();
    let rgl_diffuse = opened(&rgl(DIFFUSE, 0.8, &Resolution::default()));
    let rgl_glossy = opened(&rgl(GLOSSY, 0.2, &Resolution::default()));
    for (name, table, of, most, worst, rms) in [
        ("merl diffuse", opened(&merl(DIFFUSE)), DIFFUSE, 1.2, 0.02, 0.003),
        ("merl glossy", opened(glossy()), GLOSSY, 1.2, 0.03, 0.006),
        ("merl glossy, nearest", nearest, GLOSSY, 1.2, 0.25, 0.05),
        ("rgl diffuse", rgl_diffuse, DIFFUSE, 1.0, 0.12, 0.02),
        ("rgl glossy", rgl_glossy, GLOSSY, 1.0, 0.3, 0.05),
    ] {
        let found = difference(&*table, of, most);
        println!("{name}: {found:.4?}");
        assert!(found[0] < worst && found[1] < rms, "{name}: {found:?}");
    }
}

/// A quarter of a turn of azimuths, which the reader unfolds; and spectra.
#[test]
fn anisotropic_and_spectral_files_are_read() {
    let name = "torrance-sparrow:alpha=0.3,alpha_y=0.5";
    for (parts, count) in [(4.0, 5), (2.0, 9), (1.0, 17)] {
        let phi = (0..count).map(|k| 2.0 * PI / parts * f64::from(k) / f64::from(count - 1) - PI).collect();
        let resolution = Resolution { phi, theta: 12, normals: 48, spectra: 24 };
        let subject = model(name);
        let wavelengths: Vec<f32> = (0..16u8).map(|k| 400.0 + 10.0 * f32::from(k)).collect();
        let bytes = Rgl::bake("two roughnesses", &wavelengths, 0.4, &resolution, |wo, wi| {
            Spectrum::uniform(16, value(&*subject, wo, wi)[0])
        });
        let table = opened(&bytes);
        let description = table.describe();
        assert!(!description.claims.isotropic && description.name == "two roughnesses");
        assert_eq!((description.channels.len(), &description.channels[1][..]), (16, "410.0nm"));
        let (mut squares, mut n) = (0.0, 0.0);
        for k in 0..500 {
            let at = |a: f64| (a * f64::from(k)).fract();
            let wo = Direction::from_angles(1.1 * at(0.618_034), 6.2 * at(0.414_214));
            let wi = Direction::from_angles(1.1 * at(0.732_051), 6.2 * at(0.236_068));
            let mut found = [0.0; 16];
            table.eval(wo, &[wi], Transport::Radiance, &mut found).unwrap();
            let expected = value(&*subject, wo, wi)[0];
            squares += ((found[3] - expected) / found[3].max(expected)).powi(2);
            n += 1.0;
        }
        let rms = f64::sqrt(squares / n);
        assert!(rms < 0.12, "{parts}: {rms}");
        let results = measure([30.0, 75.0].map(|theta| case("aniso", table.clone(), theta, &[])).into());
        for verdict in [Verdict::Fail, Verdict::Error] {
            assert_eq!(told(&results, verdict), [""; 0]);
        }
    }
}

/// A MERL file whose writer puts f elsewhere, or scales it otherwise.
fn planted(bug: impl Fn([usize; 3], &mut [f64; 3]) -> [usize; 3]) -> Vec<u8> {
    let right = glossy();
    let mut bytes = right.to_vec();
    let at = |c: usize, [i, j, k]: [usize; 3]| 12 + 8 * (k + 180 * (j + 90 * i) + c * 90 * 90 * 180);
    for i in 0..90 {
        for j in 0..90 {
            for k in 0..180 {
                let mut scale = [1.0; 3];
                let from = bug([i, j, k], &mut scale);
                for c in 0..3 {
                    let from = at(c, from);
                    let v = f64::from_le_bytes(right[from..from + 8].try_into().unwrap()) * scale[c];
                    bytes[at(c, [i, j, k])..][..8].copy_from_slice(&v.to_le_bytes());
                }
            }
        }
    }
    bytes
}

#[test]
fn wrong_tables_differ_from_their_reference() {
    let verdict = |bytes: &[u8]| {
        let mut one = case("table", opened(bytes), 40.0, &["reference"]);
        one.company.reference = Some((GLOSSY.into(), model(GLOSSY)));
        let outcome = measure(vec![one]).remove(0).findings.remove(0).outcome;
        (outcome.verdict, outcome.message)
    };
    let (right, message) = verdict(glossy());
    assert_eq!(right, Verdict::Pass, "{message}");
    let bugs = [
        // θh divided evenly: cell i begins at i/90 and not at (i/90)².
        ("no square root", planted(|[i, j, k], _| [((i as f64 / 90.0).sqrt() * 90.0) as usize, j, k])),
        ("transposed", planted(|[i, j, k], _| [j, i, k])),
        (
            "scales swapped",
            planted(|cell, scale| {
                *scale = [1.66, 1.0, 1.0 / 1.66];
                cell
            }),
        ),
    ];
    for (name, bytes) in bugs {
        let (found, message) = verdict(&bytes);
        assert_eq!(found, Verdict::Fail, "{name}: {message}");
    }
}

/// A table whose density lacks the Jacobian of s = √(1 − cos θ).
struct NoJacobian(Arc<dyn Subject>);

impl Subject for NoJacobian {
    fn describe(&self) -> Description {
        self.0.describe()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.0.eval(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.0.pdf(wo, wi, transport, out)?;
        out.iter_mut().zip(wi).for_each(|(p, wi)| *p *= 2.0 * (1.0 - wi.z).max(0.0).sqrt());
        Ok(())
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        self.0.sample(wo, u, transport, out)
    }
}

#[test]
fn a_density_without_its_jacobian_is_found() {
    let checks = ["goodness-of-fit", "jacobian", "returned-pdf"];
    let right = measure(vec![case("right", opened(glossy()), 60.0, &checks)]);
    assert_eq!(told(&right, Verdict::Pass).len(), 3);
    let wrong = measure(vec![case("wrong", Arc::new(NoJacobian(opened(glossy()))), 60.0, &checks)]);
    assert_eq!(told(&wrong, Verdict::Fail).len(), 3, "{:?}", told(&wrong, Verdict::Pass));
}

#[test]
fn energy_sees_too_much_light_and_bounds_missing_light_from_below() {
    let bright = MerlTable::bake(|_, _| [0.1, 0.5, 0.1]);
    let results = measure(vec![case("bright", opened(&bright), 30.0, &["energy"])]);
    let found = told(&results, Verdict::Fail);
    // ρ = π/2.
    assert!(found.len() == 1 && found[0].contains("flux 1.57"), "{found:?}");
    // Differences above 20° are missing: what is known stays below 1.
    let mut holes = bright.clone();
    for (index, eight) in holes[12..].chunks_exact_mut(8).enumerate() {
        if index / 180 % 90 >= 20 {
            eight.copy_from_slice(&(-1.0f64).to_le_bytes());
        }
    }
    let results = measure(vec![case("holes", opened(&holes), 30.0, &["energy"])]);
    let found = told(&results, Verdict::Pass);
    assert!(found.len() == 1 && found[0].contains("% of the table being missing"), "{found:?}");
}

/// A fifth of the cells is missing here and there, as no interpolation likes it.
#[test]
fn scattered_holes_raise_no_false_alarm() {
    let mut bytes = glossy().to_vec();
    for cell in (0..90 * 90 * 180usize).filter(|k| k.wrapping_mul(0x9e37_79b9) >> 7 & 1023 < 205) {
        for c in 0..3 {
            let at = 12 + 8 * (cell + c * 90 * 90 * 180);
            bytes[at..at + 8].copy_from_slice(&(-1.0f64).to_le_bytes());
        }
    }
    let table = opened(&bytes);
    let missing = table.describe().table.unwrap().missing;
    assert!((missing - 0.2).abs() < 0.01, "{missing}");
    let results = measure([0.0, 60.0, 85.0].map(|theta| case("holes", table.clone(), theta, &[])).into());
    for verdict in [Verdict::Fail, Verdict::Error, Verdict::Inconclusive] {
        assert_eq!(told(&results, verdict), [""; 0]);
    }
}

#[test]
fn bad_files_are_told_with_place_and_values() {
    let error = |bytes: &[u8]| read(bytes, &Reading::default()).err().expect("an error").to_string();
    let mut swapped = glossy()[..12].to_vec();
    for four in swapped.chunks_exact_mut(4) {
        four.reverse();
    }
    let mut nan = glossy().to_vec();
    let at = 12 + 8 * (90 * 90 * 180 + 5 * 90 * 180 + 7 * 180 + 9);
    nan[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    let mut odd: Vec<u8> = [2i32, 3, 4].iter().flat_map(|n| n.to_le_bytes()).collect();
    odd.resize(12 + 24 * 24, 0);
    for (bytes, part) in [
        (&glossy()[..100], "byte 100: 90 × 90 × 180 cells of three f64 need 34992000 bytes after the header"),
        (&[glossy(), &[0]].concat(), "too long"),
        (
            &swapped,
            "byte 0: the dimensions are 1509949440 × 1509949440 × -1275068416, the right ones in big-endian",
        ),
        (&odd, "byte 0: the dimensions are 2 × 3 × 4; they must be 90 × 90 × 180"),
        (&nan, "byte 12322164: the value of channel g at θh cell 5, θd cell 7, φd cell 9 is NaN"),
        (b"\x89PNG\r\n\x1a\n", "this is a PNG picture; gonio reads MERL"),
        (b"IESNA91", "IES photometric"),
        (b"", "an empty file"),
        (b"no table", "not a format that gonio knows (it begins with `no table`)"),
        (b"\0\x01\x02", "it begins with bytes 00 01 02"),
    ] {
        let found = error(bytes);
        assert!(found.contains(part), "{found}");
    }
    let tensor = gonio::measured::tensor_file::write(&[(
        "theta_h",
        vec![1],
        gonio::measured::tensor_file::Content::Floats(vec![0.0]),
    )]);
    let found = error(&tensor);
    assert!(found.contains("without `theta_i`: it seems a table over half and difference angles"), "{found}");
    assert!(found.contains("its fields are theta_h"), "{found}");
}
