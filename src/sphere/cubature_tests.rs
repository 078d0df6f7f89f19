use super::super::chart::STERADIANS;
use super::*;
use std::f64::consts::PI;

fn goal(components: usize) -> Goal {
    Goal {
        components,
        controlled: components - 1,
        draws: 1 << 20,
        mass: 1e-6,
        value: 1e-6,
        evaluations: 1 << 20,
        independent: false,
        horizon: 0.0,
    }
}

fn run(pilot: Vec<Point>, markers: &[Marker], f: impl Fn(Direction) -> f64) -> LeafIntegrals {
    let partition = Partition::build(Chart::new(0.0), pilot.clone(), 1024);
    integrate(&partition, &pilot, markers, &goal(1), |wi, out| {
        for (wi, out) in wi.iter().zip(out) {
            *out = f(*wi);
        }
        Ok::<_, ()>(())
    })
    .unwrap()
}

/// A von Mises–Fisher lobe, whose integral over the sphere is exactly 1.
fn von_mises_fisher(kappa: f64, axis: Direction) -> impl Fn(Direction) -> f64 {
    move |wi| {
        // 1 − cos = |wi − axis|²/2 without cancellation.
        let d = wi - axis;
        kappa / (2.0 * PI * (1.0 - (-2.0 * kappa).exp())) * (-kappa * 0.5 * d.dot(d)).exp()
    }
}

#[test]
fn integrates_smooth_functions_without_a_pilot() {
    let cases: [(&dyn Fn(Direction) -> f64, f64); 4] = [
        (&|_| 1.0, 4.0 * PI),
        (&|wi| wi.z.max(0.0), PI),
        (&|wi| wi.x * wi.x, 4.0 * PI / 3.0),
        (&von_mises_fisher(5.0, Direction::from_angles(0.6, 2.0)), 1.0),
    ];
    for (f, exact) in cases {
        let result = run(vec![], &[], f);
        let (total, error) = result.total(0);
        assert!(result.converged);
        assert!((total - exact).abs() <= 1e-6 * exact, "{total} for {exact}");
        assert!((total - exact).abs() <= error + 1e-12);
    }
}

#[test]
fn finds_a_narrow_lobe_by_its_pilot() {
    for kappa in [1e2, 1e4, 1e6, 1e8] {
        let axis = Direction::from_angles(1.0, 2.0);
        let chart = Chart::new(0.0);
        // Points of a Fibonacci spiral about the axis with the lobe's own spread.
        let (t, b) = (axis.cross(Direction::NORMAL).normalized(), axis);
        let s = b.cross(t);
        let pilot: Vec<_> = (0..1 << 15)
            .map(|k| {
                let u = (f64::from(k) + 0.5) / f64::from(1 << 15);
                let r = (-2.0 * (1.0 - u).ln() / kappa).sqrt();
                let (sin, cos) = (2.399_963 * f64::from(k)).sin_cos();
                chart.to_point((axis + t * (r * cos) + s * (r * sin)).normalized())
            })
            .collect();
        let result = run(pilot, &[], von_mises_fisher(kappa, axis));
        let (total, _) = result.total(0);
        assert!(result.converged, "kappa {kappa}");
        assert!((total - 1.0).abs() < 1e-6, "kappa {kappa}: {total}");
        assert!(result.evaluations < 120_000, "kappa {kappa}: {}", result.evaluations);
    }
}

/// The trap: without pilot or marker the rule misses the lobe and is sure
/// of it; a marker brings it back.
#[test]
fn finds_a_narrow_lobe_by_a_marker() {
    let axis = Direction::from_angles(1.0, 2.0);
    let f = von_mises_fisher(1e8, axis);
    assert!(run(vec![], &[], &f).total(0).0 < 0.1);
    let marker = Marker { at: Chart::new(0.0).to_point(axis), reach: 0.0, density: f(axis), value: 0.0 };
    let (total, _) = run(vec![], &[marker], &f).total(0);
    // Patches beside the lobe may miss the outermost of its tail.
    assert!((total - 1.0).abs() < 1e-5, "{total}");
}

/// A few points that fill the cell do not hide the crowd of the others.
#[test]
fn finds_a_narrow_lobe_in_a_cell_that_other_points_fill() {
    let chart = Chart::new(0.0);
    let f = von_mises_fisher(1e8, Direction::from_angles(1.0, 2.0));
    let at = |theta, phi| chart.to_point(Direction::from_angles(theta, phi));
    let crowd = (0..20).map(|k| 1e-5 * (f64::from(k) - 9.5)).map(|x| at(1.0 + x, 2.0 - x));
    let others =
        (0..8).map(|k| (0.6 * f64::from(k)).sin_cos()).map(|(s, c)| at(1.0 + 0.04 * s, 2.0 + 0.04 * c));
    let pilot: Vec<Point> = crowd.chain(others).collect();
    let partition = Partition::build(chart, vec![], 1);
    let lobe = |wi: &[Direction], out: &mut [f64]| {
        wi.iter().zip(out).for_each(|(wi, out)| *out = f(*wi));
        Ok::<_, ()>(())
    };
    let (total, _) = integrate(&partition, &pilot, &[], &goal(1), lobe).unwrap().total(0);
    assert!((total - 1.0).abs() < 1e-4, "{total}");
}

/// The rim of a narrow lobe over a wide one lies in leaves that the wide one's
/// points fill; a marker at each point brings it back.
#[test]
fn keeps_the_rim_of_a_narrow_lobe_over_a_wide_one() {
    let axis = Direction::from_angles(0.5, 0.3);
    let chart = Chart::new(0.0);
    let (kappa, share) = (1e5, 0.8);
    let narrow = von_mises_fisher(kappa, axis);
    let f = |wi: Direction| share * wi.z.max(0.0) / PI + (1.0 - share) * narrow(wi);
    let t = axis.cross(Direction::NORMAL).normalized();
    let s = axis.cross(t);
    let n = 1 << 15;
    let wi: Vec<_> = (0..n)
        .map(|k| {
            let u = (f64::from(k) * 0.754_877_666).fract();
            let (sin, cos) = (2.399_963 * f64::from(k)).sin_cos();
            if (f64::from(k) * 0.569_840_291).fract() < share {
                return Direction::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt());
            }
            let r = (-2.0 * (1.0 - u).ln() / kappa).sqrt();
            (axis + t * (r * cos) + s * (r * sin)).normalized()
        })
        .collect();
    let pilot: Vec<_> = wi.iter().map(|wi| chart.to_point(*wi)).collect();
    let markers: Vec<_> = wi
        .iter()
        .zip(&pilot)
        .map(|(wi, at)| {
            let density = f(*wi);
            let reach = 0.5 / (density * STERADIANS * f64::from(n)).sqrt();
            Marker { at: *at, reach, density, value: 0.0 }
        })
        .collect();
    let without = run(pilot.clone(), &[], f).total(0).0;
    let with = run(pilot, &markers, f).total(0).0;
    assert!((without - 1.0).abs() > 2e-4, "{without}");
    assert!((with - 1.0).abs() < 1e-6, "{with}");
}

/// A layer at the horizon that no node of the leaves meets: f = min(cos θ/c, 1) has
/// the integral 2π (1 − c/2).
#[test]
fn finds_what_changes_at_the_horizon_only() {
    let partition = Partition::build(Chart::new(0.0), vec![], 1024);
    for c in [1e-2, 1e-3, 1e-4] {
        let total = |horizon| {
            let goal = Goal { horizon, ..goal(1) };
            let layer = |wi: &[Direction], out: &mut [f64]| {
                wi.iter().zip(out).for_each(|(wi, out)| *out = (wi.z / c).clamp(0.0, 1.0));
                Ok::<_, ()>(())
            };
            integrate(&partition, &[], &[], &goal, layer).unwrap().total(0).0 / (2.0 * PI)
        };
        assert!((total(0.0) - 1.0).abs() < 0.1 * c, "{}", total(0.0));
        assert!((total(c) - (1.0 - 0.5 * c)).abs() < 2e-6, "{c}: {}", total(c));
    }
}

/// Values are integrated from the patches of pdf on: where they are sharper, patches are
/// halved further, with the markers that a patch has kept.
#[test]
fn another_function_goes_on_from_the_patches_of_the_first() {
    let axis = Direction::from_angles(1.0, 2.0);
    let (wide, narrow) = (von_mises_fisher(20.0, axis), von_mises_fisher(1e7, axis));
    let chart = Chart::new(0.0);
    let partition = Partition::build(chart, vec![], 1024);
    let marker = |density, value| Marker { at: chart.to_point(axis), reach: 0.0, density, value };
    let patches = Patches::new(None, &partition, &[], &[marker(wide(axis), 0.0)], 0.0);
    let pdf = |wi: &[Direction], out: &mut [f64]| {
        wi.iter().zip(out).for_each(|(wi, out)| *out = wide(*wi));
        Ok::<_, ()>(())
    };
    let markers = [marker(wide(axis), 0.0)];
    let (first, patches) = integrate_on(patches, &partition, 0, &markers, &goal(1), pdf).unwrap();
    let both = |wi: &[Direction], out: &mut [f64]| {
        for (wi, out) in wi.iter().zip(out.as_chunks_mut::<2>().0) {
            *out = [wide(*wi), narrow(*wi)];
        }
        Ok::<_, ()>(())
    };
    let markers = [marker(0.0, narrow(axis))];
    let goal = Goal { draws: 0, mass: f64::MAX, ..goal(2) };
    let (second, _) = integrate_on(patches, &partition, 0, &markers, &goal, both).unwrap();
    assert!(first.converged && second.converged);
    assert!((first.total(0).0 - 1.0).abs() < 1e-6);
    // Patches beside the lobe may miss the outermost of its tail.
    assert!((second.total(1).0 - 1.0).abs() < 1e-5, "{}", second.total(1).0);
    assert!(second.patches.len() > first.patches.len());
}

#[test]
fn says_when_it_gives_up() {
    let partition = Partition::build(Chart::new(0.0), vec![], 1024);
    let mut few = goal(1);
    few.evaluations = 5000;
    let rough = |wi: &[Direction], out: &mut [f64]| {
        for (wi, out) in wi.iter().zip(out) {
            *out = 1.0 + (1e4 * wi.x).sin();
        }
        Ok::<_, ()>(())
    };
    assert!(!integrate(&partition, &[], &[], &few, rough).unwrap().converged);
}

#[test]
fn passes_errors_on() {
    let partition = Partition::build(Chart::new(0.0), vec![], 1024);
    let result = integrate(&partition, &[], &[], &goal(1), |_, _| Err("broken"));
    assert_eq!(result.unwrap_err(), "broken");
}
