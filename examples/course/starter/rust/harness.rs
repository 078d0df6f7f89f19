//! What gonio calls (gonio.h), made of the functions of brdf.rs. Not yours to change:
//! grading puts the course's own in its place.
//!
//!     rustc --edition 2021 --crate-type cdylib -O harness.rs -o brdf.so

#[allow(unused_variables, dead_code)]
mod brdf;
#[allow(dead_code, unused_imports)]
mod course;

use course::{vec3, Brdf, Diffuse, Lobe, Metal, Plastic, Vec3};
use std::ffi::{c_char, c_int, c_void, CStr};
use std::ptr::null;
use std::slice::{from_raw_parts, from_raw_parts_mut};

const DESCRIPTION: &CStr = cr#"{
    "protocol": 1,
    "models": [{
        "name": "diffuse", "doc": "Lambert's reflector", "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [
            {"name": "reflectance", "type": "number", "default": 0.5, "min": 0, "max": 1,
             "doc": "share of the light that is reflected"}
        ]
    }, {
        "name": "metal", "doc": "GGX facets, Smith's masking, Schlick's Fresnel term", "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [
            {"name": "alpha", "type": "number", "default": 0.3, "min": 0.05, "max": 1,
             "doc": "roughness", "role": "roughness"},
            {"name": "f0", "type": "number", "default": 0.9, "min": 0, "max": 1,
             "doc": "reflectance of a facet at normal incidence"}
        ]
    }, {
        "name": "plastic", "doc": "a rough dielectric coat beside a diffuse base", "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [
            {"name": "alpha", "type": "number", "default": 0.3, "min": 0.05, "max": 1,
             "doc": "roughness of the coat"},
            {"name": "eta", "type": "number", "default": 1.5, "min": 1, "max": 3,
             "doc": "index of refraction of the coat"},
            {"name": "ks", "type": "number", "default": 0.4, "min": 0.05, "max": 0.95,
             "doc": "share of the coat, and the probability with which it is drawn from"},
            {"name": "reflectance", "type": "number", "default": 0.8, "min": 0, "max": 1,
             "doc": "of the base"}
        ]
    }]
}"#;

const WHITE: &CStr = cr#"{"claims": {"isotropic": true, "lossless": true}}"#;

/// Flags of gonio.h.
const REFLECTION: f64 = 1.0;
const DIFFUSE: f64 = 4.0;
const GLOSSY: f64 = 8.0;

/// What a handle points to.
struct Handle {
    brdf: Box<dyn Brdf>,
    /// A white diffuse reflector loses nothing.
    lossless: bool,
}

/// The number called `name` in a flat JSON object.
fn number(parameters: &str, name: &str, otherwise: f64) -> f64 {
    let quoted = format!("\"{name}\"");
    let value = || {
        let rest = parameters.split_once(&quoted)?.1.trim_start().strip_prefix(':')?;
        rest.split([',', '}']).next()?.trim().parse().ok()
    };
    value().unwrap_or(otherwise)
}

fn made(model: &str, parameters: &str) -> Option<Handle> {
    let number = |name, otherwise| number(parameters, name, otherwise);
    let brdf: Box<dyn Brdf> = match model {
        "diffuse" => Box::new(Diffuse { reflectance: number("reflectance", 0.5) }),
        "metal" => Box::new(Metal { alpha: number("alpha", 0.3), f0: number("f0", 0.9) }),
        "plastic" => Box::new(Plastic {
            alpha: number("alpha", 0.3),
            eta: number("eta", 1.5),
            ks: number("ks", 0.4),
            reflectance: number("reflectance", 0.8),
        }),
        _ => return None,
    };
    Some(Handle { brdf, lossless: model == "diffuse" && number("reflectance", 0.5) == 1.0 })
}

fn row(array: &[f64], k: usize) -> Vec3 {
    vec3(array[3 * k], array[3 * k + 1], array[3 * k + 2])
}

#[no_mangle]
pub unsafe extern "C" fn gonio_describe(handle: *mut c_void) -> *const c_char {
    if handle.is_null() {
        DESCRIPTION.as_ptr()
    } else if (*handle.cast::<Handle>()).lossless {
        WHITE.as_ptr()
    } else {
        null()
    }
}

#[no_mangle]
pub extern "C" fn gonio_error() -> *const c_char {
    c"there are diffuse, metal and plastic".as_ptr()
}

#[no_mangle]
pub unsafe extern "C" fn gonio_create(model: *const c_char, parameters: *const c_char) -> *mut c_void {
    let text = |p: *const c_char| CStr::from_ptr(p).to_string_lossy();
    match made(&text(model), &text(parameters)) {
        Some(handle) => Box::into_raw(Box::new(handle)).cast(),
        None => std::ptr::null_mut(),
    }
}

#[no_mangle]
pub unsafe extern "C" fn gonio_destroy(handle: *mut c_void) {
    drop(Box::from_raw(handle.cast::<Handle>()));
}

#[no_mangle]
pub unsafe extern "C" fn gonio_eval(
    handle: *mut c_void,
    _mode: c_int,
    wo: *const f64,
    n: usize,
    wi: *const f64,
    f: *mut f64,
) -> c_int {
    let brdf = &(*handle.cast::<Handle>()).brdf;
    let (wo, wi) = (row(from_raw_parts(wo, 3), 0), from_raw_parts(wi, 3 * n));
    for (k, f) in from_raw_parts_mut(f, n).iter_mut().enumerate() {
        *f = brdf.eval(wo, row(wi, k));
    }
    0
}

#[no_mangle]
pub unsafe extern "C" fn gonio_pdf(
    handle: *mut c_void,
    _mode: c_int,
    wo: *const f64,
    n: usize,
    wi: *const f64,
    pdf: *mut f64,
) -> c_int {
    let brdf = &(*handle.cast::<Handle>()).brdf;
    let (wo, wi) = (row(from_raw_parts(wo, 3), 0), from_raw_parts(wi, 3 * n));
    for (k, pdf) in from_raw_parts_mut(pdf, n).iter_mut().enumerate() {
        *pdf = brdf.pdf(wo, row(wi, k));
    }
    0
}

#[no_mangle]
pub unsafe extern "C" fn gonio_sample(
    handle: *mut c_void,
    _mode: c_int,
    wo: *const f64,
    n: usize,
    u: *const f64,
    wi: *mut f64,
    weight: *mut f64,
    pdf: *mut f64,
    flags: *mut f64,
) -> c_int {
    let brdf = &(*handle.cast::<Handle>()).brdf;
    let (wo, u) = (row(from_raw_parts(wo, 3), 0), from_raw_parts(u, 2 * n));
    let (wi, weight) = (from_raw_parts_mut(wi, 3 * n), from_raw_parts_mut(weight, n));
    let (pdf, flags) = (from_raw_parts_mut(pdf, n), from_raw_parts_mut(flags, n));
    for k in 0..n {
        let Some(s) = brdf.sample(wo, u[2 * k], u[2 * k + 1]) else {
            (weight[k], pdf[k], flags[k]) = (0.0, 0.0, 0.0);
            wi[3 * k..3 * k + 3].fill(0.0);
            continue;
        };
        wi[3 * k..3 * k + 3].copy_from_slice(&[s.wi.x, s.wi.y, s.wi.z]);
        (weight[k], pdf[k]) = (s.weight, s.pdf);
        flags[k] = REFLECTION + if s.lobe == Lobe::Diffuse { DIFFUSE } else { GLOSSY };
    }
    0
}
