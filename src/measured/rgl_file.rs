//! The fields of an RGL file: `description` (u8), `phi_i` and `theta_i` (f32,
//! radians), `ndf` and `sigma` [v, u], `vndf` and `luminance` [φi, θi, y, x],
//! `spectra` [φi, θi, wavelength, y, x] with `wavelengths` (nm) or `rgb` [φi, θi,
//! 3, y, x], and `jacobian` (u8), which says whether spectra are divided by
//! D/(4σ).

use super::bytes::FormatError;
use super::rgl::{Rgl, Scale};
use super::tensor_file::{Field, NAME as TENSOR, TensorFile};
use super::warp::{Grid, Warp};
use crate::bsdf::MAX_CHANNELS;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) const NAME: &str = "RGL tensor .bsdf";

/// Rounding of angles stored as f32.
const ANGLE: f64 = 1e-5;

fn wrong(field: &Field, message: impl std::fmt::Display) -> FormatError {
    FormatError::new(NAME, field.offset, format!("`{}` {message}", field.name))
}

/// What other tensor files are known to hold, by a field of theirs.
const OTHERS: [(&str, &str); 2] = [
    ("M", "a polarimetric table of Mueller matrices (Baek et al. 2020)"),
    ("theta_h", "a table over half and difference angles"),
];

impl Rgl {
    /// Reads the content of a file and validates all of it.
    pub fn read(bytes: &[u8]) -> Result<Self, FormatError> {
        let file = TensorFile::read(bytes)?;
        let get = |name: &str| {
            file.field(name).ok_or_else(|| {
                let other = OTHERS.iter().find(|(field, _)| file.field(field).is_some());
                let what = other.map_or("not an RGL BSDF".into(), |(_, what)| format!("it seems {what}"));
                let names = file.names();
                let message = format!("a tensor file without `{name}`: {what}; its fields are {names}");
                FormatError::new(TENSOR, 0, message)
            })
        };
        let theta_field = get("theta_i")?;
        let phi_field = get("phi_i")?;
        let theta = angles(theta_field, 0.0, FRAC_PI_2)?;
        let phi = angles(phi_field, -TAU, TAU)?;
        let isotropic = phi.len() <= 2;
        let fold = if isotropic { 1 } else { fold(phi_field, &phi)? };
        let given = [phi.len(), theta.len()];
        let jacobian = get("jacobian")?;
        let scaled = match (jacobian.bytes()?, &jacobian.shape[..]) {
            (&[flag], [1]) => flag != 0,
            _ => return Err(wrong(jacobian, format!("has shape {:?}; it must be [1]", jacobian.shape))),
        };
        let (ndf, sigma) = (get("ndf")?, get("sigma")?);
        let scale = Scale { ndf: plane(ndf, 0.0)?, sigma: plane(sigma, f32::MIN_POSITIVE)? };
        let vndf = warp(get("vndf")?, given)?;
        let luminance_field = get("luminance")?;
        let luminance = warp(luminance_field, given)?;
        let (channels, spectra) = match file.field("rgb") {
            Some(rgb) => colours(rgb, given)?,
            None => spectral(get("spectra")?, get("wavelengths")?, given)?,
        };
        let name = match file.field("description").map(Field::bytes).transpose()? {
            Some(text) => String::from_utf8_lossy(text).trim_end_matches('\0').trim().to_string(),
            None => String::new(),
        };
        let name = if name.is_empty() { "rgl".into() } else { name };
        let scale = scaled.then_some(scale);
        Ok(Self { name, channels, phi, theta, scale, vndf, luminance, spectra, isotropic, fold })
    }
}

/// Increasing angles from `least` to `most`.
fn angles(field: &Field, least: f64, most: f64) -> Result<Vec<f64>, FormatError> {
    if field.shape.len() != 1 || field.shape[0] == 0 {
        return Err(wrong(field, format!("has shape {:?}; it must be one list of angles", field.shape)));
    }
    let must = format!("an angle from {least:.4} to {most:.4} radians");
    let within = |v: f32| f64::from(v) >= least - ANGLE && f64::from(v) <= most + ANGLE;
    let values = field.floats(&must, within)?;
    match values.windows(2).position(|two| !(two[1] > two[0])) {
        Some(k) => {
            let (a, b) = (values[k], values[k + 1]);
            Err(wrong(field, format!("must increase, and value {} is {b} after {a}", k + 1)))
        }
        None => Ok(values),
    }
}

/// Into how many parts of 2π measured azimuths fold.
fn fold(field: &Field, phi: &[f64]) -> Result<u32, FormatError> {
    let (first, last) = (phi[0], phi[phi.len() - 1]);
    let parts = (TAU / (last - first)).round();
    if (first + PI).abs() > 0.1 || !(parts == 1.0 || parts == 2.0 || parts == 4.0) {
        let message = format!(
            "runs from {first:.4} to {last:.4}; azimuths from −π over a whole, a half or a quarter turn can \
             be read"
        );
        return Err(wrong(field, message));
    }
    Ok(parts as u32)
}

/// One function of the square, of at least `least`.
fn plane(field: &Field, least: f32) -> Result<Grid, FormatError> {
    let [rows, columns] = field.shape[..] else {
        return Err(wrong(field, format!("has shape {:?}; it must have two dimensions", field.shape)));
    };
    let columns_and_rows = nodes(field, [columns, rows])?;
    let must = if least > 0.0 { "finite and above 0" } else { "finite and not negative" };
    let values = field.floats(must, |v| v.is_finite() && v >= least)?;
    Ok(Grid::new(columns_and_rows, 1, values))
}

fn nodes(field: &Field, [nx, ny]: [usize; 2]) -> Result<[usize; 2], FormatError> {
    if nx >= 2 && ny >= 2 {
        return Ok([nx, ny]);
    }
    Err(wrong(field, format!("has {ny} × {nx} nodes; at least 2 × 2 span a square")))
}

/// Densities of the square for each stored wo.
fn warp(field: &Field, [phi, theta]: [usize; 2]) -> Result<Warp, FormatError> {
    let (a, b, ny, nx) = match field.shape[..] {
        [a, b, ny, nx] if [a, b] == [phi, theta] => (a, b, ny, nx),
        _ => {
            let message = format!("has shape {:?}; it must be [{phi}, {theta}, y, x]", field.shape);
            return Err(wrong(field, message));
        }
    };
    let size = nodes(field, [nx, ny])?;
    let values = field.floats("finite and not negative", |v| v.is_finite() && v >= 0.0)?;
    Warp::new(size, values).map_err(|slice| {
        let at = field.offset + 4 * slice * nx * ny;
        let message = format!(
            "`{}` is 0 all over for φi {} and θi {} of {a} × {b}: no density",
            field.name,
            slice / theta,
            slice % theta
        );
        FormatError::new(NAME, at, message)
    })
}

/// r, g and b. Colours beyond the gamut are negative, and count as 0 where they
/// are used.
fn colours(field: &Field, given: [usize; 2]) -> Result<(Vec<String>, Grid), FormatError> {
    let channels = ["r", "g", "b"].map(String::from).to_vec();
    let grid = layers(field, given, 3, &[0, 1, 2])?;
    Ok((channels, grid))
}

/// Some of the measured wavelengths: all if they are few, else as many as a
/// subject may have, nearest to evenly spaced from the first to the last. The
/// channels' names say which.
fn spectral(
    field: &Field,
    wavelengths: &Field,
    given: [usize; 2],
) -> Result<(Vec<String>, Grid), FormatError> {
    let count = match wavelengths.shape[..] {
        [count] if count > 0 => count,
        _ => {
            let message = format!("has shape {:?}; it must be one list of wavelengths", wavelengths.shape);
            return Err(wrong(wavelengths, message));
        }
    };
    let nm = wavelengths.floats("a positive wavelength in nm", |v| v.is_finite() && v > 0.0)?;
    if let Some(k) = nm.windows(2).position(|two| !(two[1] > two[0])) {
        let message = format!("must increase, and value {} is {} after {}", k + 1, nm[k + 1], nm[k]);
        return Err(wrong(wavelengths, message));
    }
    let chosen = nearest_even(&nm, count.min(MAX_CHANNELS));
    let grid = layers(field, given, count, &chosen)?;
    Ok((chosen.iter().map(|k| format!("{:.1}nm", nm[*k])).collect(), grid))
}

/// Indices of `count` different values, nearest to evenly spaced ones.
fn nearest_even(values: &[f64], count: usize) -> Vec<usize> {
    let (first, last) = (values[0], values[values.len() - 1]);
    let mut chosen: Vec<usize> = Vec::new();
    for k in 0..count {
        let wanted = first + (last - first) * k as f64 / (count.max(2) - 1) as f64;
        let distance = |i: &usize| (values[*i] - wanted).abs();
        // Room is left for those that follow.
        let from = chosen.last().map_or(0, |i| i + 1);
        let to = values.len() - (count - 1 - k);
        chosen.extend((from..to).min_by(|a, b| distance(a).total_cmp(&distance(b))));
    }
    chosen
}

/// The `chosen` of `depth` layers [φi, θi, layer, y, x], side by side at each node.
fn layers(
    field: &Field,
    [phi, theta]: [usize; 2],
    depth: usize,
    chosen: &[usize],
) -> Result<Grid, FormatError> {
    let (ny, nx) = match field.shape[..] {
        [a, b, c, ny, nx] if [a, b, c] == [phi, theta, depth] => (ny, nx),
        _ => {
            let message = format!("has shape {:?}; it must be [{phi}, {theta}, {depth}, y, x]", field.shape);
            return Err(wrong(field, message));
        }
    };
    let size = nodes(field, [nx, ny])?;
    let stored = field.floats("finite", f32::is_finite)?;
    let area = nx * ny;
    let mut values = Vec::with_capacity(phi * theta * area * chosen.len());
    for slice in stored.chunks_exact(depth * area) {
        for node in 0..area {
            values.extend(chosen.iter().map(|layer| slice[layer * area + node]));
        }
    }
    Ok(Grid::new(size, chosen.len(), values))
}
