//! Tabulates a registered subject as a measured file:
//! `cargo run --release --example bake -- merl torrance-sparrow:alpha=0.2 ggx.binary`
//! or `… -- rgl torrance-sparrow:alpha=0.2 ggx.bsdf 0.2`, where the last number is
//! the roughness that guides the nodes of the RGL file.

use gonio::bsdf::{Direction, Spectrum, Subject, Transport};
use gonio::measured::{MerlTable, Resolution, Rgl};
use gonio::registry::Registry;

/// f of one pair, in `channels` channels; a subject with one has it in all.
fn value(subject: &dyn Subject, own: usize, channels: usize, wo: Direction, wi: Direction) -> Spectrum {
    let mut out = vec![0.0; own];
    subject.eval(wo, &[wi], Transport::Radiance, &mut out).expect("the subject answers");
    Spectrum::from_fn(channels, |c| out[c.min(own - 1)])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (format, name, path) = match &words[..] {
        [format, name, path, ..] => (format.as_str(), name, path),
        _ => return Err("write: bake merl|rgl SUBJECT FILE [ALPHA]".into()),
    };
    let subject = Registry::builtin().resolve(&name.parse()?)?.subject;
    let own = subject.describe().channels.len();
    let bytes = match format {
        "merl" => MerlTable::bake(|wo, wi| {
            let f = value(&*subject, own, 3, wo, wi);
            [f[0], f[1], f[2]]
        }),
        "rgl" => {
            let alpha = words.get(3).map_or(Ok(0.5), |a| a.parse())?;
            let resolution = Resolution::default();
            Rgl::bake(name, &[], alpha, &resolution, |wo, wi| value(&*subject, own, 3, wo, wi))
        }
        other => return Err(format!("`{other}` is not a format; write merl or rgl").into()),
    };
    std::fs::write(path, bytes)?;
    Ok(())
}
