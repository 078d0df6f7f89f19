//! C's math.h, which WebAssembly lacks: the same numbers on all machines.

use super::host::Host;
use wasmi::{Func, Store};

macro_rules! functions {
    ($($ty:ty: $($name:ident)*;)*) => {
        /// The names of all functions.
        pub const NAMES: &[&str] = &[$($(stringify!($name),)*)*];

        fn of_libm(store: &mut Store<Host>, name: &str) -> Option<Func> {
            Some(match name {
                $($(stringify!($name) => Func::wrap(store, libm::$name as $ty),)*)*
                _ => return None,
            })
        }
    };
}

functions! {
    fn(f64) -> f64:
        acos acosh asin asinh atan atanh cbrt ceil cos cosh erf erfc exp exp10 exp2 expm1 fabs
        floor j0 j1 lgamma log log10 log1p log2 rint round roundeven sin sinh sqrt tan tanh
        tgamma trunc y0 y1;
    fn(f64, f64) -> f64:
        atan2 copysign fdim fmax fmaximum fmin fminimum fmod hypot nextafter pow remainder;
    fn(f64, f64, f64) -> f64: fma;
    fn(f64, i32) -> f64: ldexp scalbn;
    fn(f32) -> f32:
        acosf acoshf asinf asinhf atanf atanhf cbrtf ceilf cosf coshf erff erfcf expf exp10f
        exp2f expm1f fabsf floorf j0f j1f lgammaf logf log10f log1pf log2f rintf roundf
        roundevenf sinf sinhf sqrtf tanf tanhf tgammaf truncf y0f y1f;
    fn(f32, f32) -> f32:
        atan2f copysignf fdimf fmaxf fmaximumf fminf fminimumf fmodf hypotf nextafterf powf
        remainderf;
    fn(f32, f32, f32) -> f32: fmaf;
    fn(f32, i32) -> f32: ldexpf scalbnf;
}

/// The function of math.h that is called `name`.
pub fn provide(store: &mut Store<Host>, name: &str) -> Option<Func> {
    match name {
        "nearbyint" => of_libm(store, "rint"),
        "nearbyintf" => of_libm(store, "rintf"),
        _ => of_libm(store, name),
    }
}
