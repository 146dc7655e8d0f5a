//! All curves of a problem, and what they say.

use crate::curve::{Curve, Family, Reach};

/// Accuracies of the table of the fastest.
pub(crate) const TARGETS: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-9];

/// A problem and what was measured on it.
pub(crate) struct Problem {
    pub name: String,
    pub class: String,
    pub curves: Vec<Curve>,
}

impl Problem {
    /// The fastest of this crate's methods, by what each needs.
    pub(crate) fn fastest(&self, needs: impl Fn(&Curve) -> Option<Reach>) -> Option<(&Curve, Reach)> {
        let own = self.curves.iter().filter(|c| c.family != Family::Peer);
        own.filter_map(|c| Some((c, needs(c)?))).min_by(|a, b| a.1.cost().total_cmp(&b.1.cost()))
    }

    /// For the picture: every deterministic method and peer, and the quickest walks to 10⁻³ of each family.
    pub(crate) fn overview(&self) -> Vec<&Curve> {
        let mut walks: Vec<_> = self.curves.iter().filter(|c| is_walk(c) && !c.points.is_empty()).collect();
        let cost = |c: &&Curve| c.seconds_to(1e-3).map_or(f64::INFINITY, Reach::cost);
        walks.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        let best = |family: Family, most: usize| walks.iter().copied().filter(move |c| c.family == family).take(most);
        let rest = self.curves.iter().filter(|c| !is_walk(c) && !c.points.is_empty());
        best(Family::MonteCarlo, 5).chain(best(Family::Quasi, 2)).chain(best(Family::Biased, 1)).chain(rest).collect()
    }
}

pub(crate) fn is_walk(curve: &Curve) -> bool {
    matches!(curve.family, Family::MonteCarlo | Family::Quasi | Family::Biased)
}
