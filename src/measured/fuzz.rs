//! Mutated files: an error that says where, or a subject that answers; never a
//! panic.

use super::per_wo::PerWo;
use super::{Interpolation, Merl, MerlTable, Resolution, Rgl};
use crate::bsdf::{Direction, Samples, Spectrum, Subject, Transport};
use proptest::prelude::*;

const SMALL: [usize; 3] = [3, 4, 6];

fn merl() -> Vec<u8> {
    MerlTable::bake_sized(SMALL, |wo, wi| [wo.z * wi.z, 0.2, 0.1])
}

fn rgl(spectral: bool) -> Vec<u8> {
    let resolution = Resolution { phi: vec![0.0], theta: 2, normals: 4, spectra: 3 };
    let wavelengths: &[f32] = if spectral { &[400.0, 500.0] } else { &[] };
    let channels = if spectral { 2 } else { 3 };
    Rgl::bake("small", wavelengths, 0.5, &resolution, |_, _| Spectrum::uniform(channels, 0.2))
}

/// A change of some bytes, or of the length.
#[derive(Clone, Debug)]
enum Mutation {
    Byte(usize, u8),
    Word(usize, [u8; 4]),
    End(usize),
    Grow(usize),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let interesting = prop::sample::select(vec![
        [0, 0, 0, 0],
        [0xff; 4],
        [0, 0, 0xc0, 0x7f],
        [0, 0, 0x80, 0x7f],
        [0xff, 0xff, 0x7f, 0x7f],
        [0, 0, 0, 0x80],
        [1, 0, 0, 0],
    ]);
    // The head matters more than its share of the bytes.
    let place = prop_oneof![0..400usize, any::<usize>()];
    prop_oneof![
        (place.clone(), any::<u8>()).prop_map(|(at, b)| Mutation::Byte(at, b)),
        (place.clone(), interesting).prop_map(|(at, w)| Mutation::Word(at, w)),
        place.prop_map(Mutation::End),
        (1..64usize).prop_map(Mutation::Grow),
    ]
}

fn mutated(mut bytes: Vec<u8>, mutations: &[Mutation]) -> Vec<u8> {
    for m in mutations {
        let n = bytes.len().max(1);
        match m {
            Mutation::Byte(at, b) if !bytes.is_empty() => bytes[at % n] = *b,
            Mutation::Word(at, word) => {
                let at = at % n;
                let end = (at + 4).min(bytes.len());
                bytes[at.min(end)..end].copy_from_slice(&word[..end - at.min(end)]);
            }
            Mutation::End(at) => bytes.truncate(at % n),
            Mutation::Grow(by) => bytes.resize(bytes.len() + by, 0),
            Mutation::Byte(..) => {}
        }
    }
    bytes
}

/// Asks a subject everything at a few places.
fn ask(subject: &dyn Subject) {
    let channels = subject.describe().channels.len();
    let last = 1.0 - f64::EPSILON / 2.0;
    for wo in [Direction::NORMAL, Direction::from_angles(1.0, 2.0), Direction::from_angles(1.57, -1.0)] {
        let wi = [Direction::NORMAL, wo, wo.mirrored(), Direction::from_angles(1.2, 0.1)];
        let (mut f, mut p) = (vec![0.0; 4 * channels], vec![0.0; 4]);
        subject.eval(wo, &wi, Transport::Radiance, &mut f).unwrap();
        subject.pdf(wo, &wi, Transport::Radiance, &mut p).unwrap();
        assert!(f.iter().all(|v| *v >= 0.0), "{f:?}");
        let mut samples = Samples::default();
        samples.clear(channels);
        let u = [0.0, 0.0, 0.5, 0.5, last, last];
        subject.sample(wo, &u, Transport::Radiance, &mut samples).unwrap();
        assert_eq!(samples.len(), 3);
    }
}

fn try_merl(bytes: &[u8]) {
    if let Ok(table) = MerlTable::read_sized(bytes, SMALL) {
        // Without the sampler, which costs a second for each.
        for wi in [Direction::NORMAL, Direction::from_angles(1.5, 0.3)] {
            for interpolation in [Interpolation::Linear, Interpolation::Nearest] {
                let f = table.value(Direction::from_angles(0.7, 0.0), wi, interpolation);
                assert!(f.iter().all(|v| *v >= 0.0), "{f:?}");
            }
        }
    }
}

fn try_rgl(bytes: &[u8]) {
    if let Ok(subject) = Rgl::read(bytes) {
        ask(&PerWo(subject));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn merl_files(mutations in prop::collection::vec(mutation(), 1..4)) {
        try_merl(&mutated(merl(), &mutations));
    }

    #[test]
    fn rgl_files(spectral: bool, mutations in prop::collection::vec(mutation(), 1..4)) {
        try_rgl(&mutated(rgl(spectral), &mutations));
    }
}

#[test]
fn unharmed_files_are_read() {
    let table = MerlTable::read_sized(&merl(), SMALL).unwrap();
    ask(&PerWo(Merl::new(table, Interpolation::Linear)));
    for spectral in [false, true] {
        ask(&PerWo(Rgl::read(&rgl(spectral)).unwrap()));
        for end in 0..rgl(spectral).len() {
            let error = Rgl::read(&rgl(spectral)[..end]).unwrap_err();
            assert!(error.offset <= end as u64, "{error}");
        }
    }
    for end in 0..merl().len() {
        let error = MerlTable::read_sized(&merl()[..end], SMALL).unwrap_err();
        assert!(error.offset <= end as u64, "{error}");
    }
}
