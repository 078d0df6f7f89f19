//! A module that is right, through all calls.

use super::shell::{open, shell};
use crate::bsdf::Transport;
use crate::plugins::instance::{Call, Created, Fault, Function};
use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2};

fn lambert() -> Vec<u8> {
    wat::parse_str(include_str!("lambert.wat")).expect("lambert.wat")
}

fn call(function: Function, rows: usize, input: &[f64]) -> Call<'_> {
    let wo = [0.6, 0.0, 0.8];
    Call { function, handle: 1, transport: Transport::Radiance, wo, rows, channels: 1, input }
}

#[test]
fn answers_all_calls() {
    let mut it = open(&lambert()).unwrap().start().unwrap();
    assert_eq!(it.describe().unwrap(), r#"{"models":[{"name":"lambert","dimensions":2}]}"#);
    let made = it.create("lambert", "{}").unwrap();
    assert_eq!(made, Created { handle: 1, describe: Some(r#"{"claims":{"isotropic":true}}"#.to_owned()) });

    let wi = [0.0, 0.0, 1.0, 0.6, 0.0, 0.8, 0.0, 0.6, -0.8];
    let mut f = [0.0; 3];
    it.call(&call(Function::Eval, 3, &wi), &mut f).unwrap();
    assert_eq!(f, [0.5 * FRAC_1_PI, 0.5 * FRAC_1_PI, 0.0]);
    let mut p = [0.0; 3];
    it.call(&call(Function::Pdf, 3, &wi), &mut p).unwrap();
    assert_eq!(p, [FRAC_1_PI, 0.8 * FRAC_1_PI, 0.0]);

    let u = [0.5, 0.25, 0.0, 0.0];
    let mut answer = [0.0; 12];
    it.call(&call(Function::Sample, 2, &u), &mut answer).unwrap();
    let (wi, rest) = answer.split_at(6);
    let expected = [FRAC_1_SQRT_2 * libm::cos(std::f64::consts::FRAC_PI_2), FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    assert!(wi[..3].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{wi:?}");
    assert_eq!(wi[3..], [0.0, 0.0, 1.0]);
    assert_eq!(rest[..2], [0.5, 0.5]);
    assert_eq!(rest[2..4], [wi[2] * FRAC_1_PI, FRAC_1_PI]);
    assert_eq!(rest[4..], [5.0, 5.0]);
    it.destroy(1).unwrap();
}

#[test]
fn a_model_that_is_not_there_is_refused_and_the_next_is_made() {
    let mut it = open(&lambert()).unwrap().start().unwrap();
    let refused = Fault::Refused("there is no such model; there is lambert".to_owned());
    assert_eq!(it.create("phong", "{}"), Err(refused));
    assert!(it.create("lambert", "{}").is_ok());
}

/// Larger batches move the buffer, also by growing the memory; smaller ones stay in it.
#[test]
fn batches_of_all_sizes() {
    let mut it = open(&lambert()).unwrap().start().unwrap();
    for rows in [1, 100_000, 3, 0, 4096, 200_000] {
        let wi: Vec<f64> = (0..rows).flat_map(|i| [0.0, 0.0, 1.0 + i as f64]).collect();
        let mut p = vec![0.0; rows];
        it.call(&call(Function::Pdf, rows, &wi), &mut p).unwrap();
        assert!(p.iter().enumerate().all(|(i, p)| *p == FRAC_1_PI * (1.0 + i as f64)), "{rows} rows");
    }
}

#[test]
fn every_instance_has_its_own_memory() {
    let module = open(&lambert()).unwrap();
    let threads: Vec<_> = (0..4)
        .map(|_| {
            let module = module.clone();
            std::thread::spawn(move || {
                let mut it = module.start().unwrap();
                let mut p = vec![0.0; 1000];
                for _ in 0..20 {
                    it.call(&call(Function::Pdf, 1000, &[1.0; 3000]), &mut p).unwrap();
                    assert!(p.iter().all(|p| *p == FRAC_1_PI));
                }
            })
        })
        .collect();
    for thread in threads {
        thread.join().unwrap();
    }
}

#[test]
fn what_is_not_written_is_nan_and_not_an_old_answer() {
    let mut it = open(&shell(&[])).unwrap().start().unwrap();
    let mut f = [0.0; 4];
    it.call(&call(Function::Eval, 4, &[1.0; 12]), &mut f).unwrap();
    assert!(f.iter().all(|f| f.is_nan()));
}

/// A file that was changed anywhere is refused or runs within its limits: nothing panics.
#[test]
fn damaged_modules_do_no_harm() {
    let good = lambert();
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..2000 {
        let mut bytes = good.clone();
        for _ in 0..=next(3) {
            let at = next(bytes.len());
            bytes[at] = next(256) as u8;
        }
        let Ok(module) = open(&bytes) else { continue };
        let Ok(mut it) = module.start() else { continue };
        let _ = it.describe();
        let _ = it.create("lambert", "{}");
        let mut answer = [0.0; 12];
        let _ = it.call(&call(Function::Sample, 2, &[0.5; 4]), &mut answer);
        let _ = it.call(&call(Function::Eval, 2, &[0.5; 6]), &mut answer[..2]);
        let _ = it.destroy(1);
    }
}
