//! Linear and logarithmic axes: range, major ticks with labels, minor ticks without.

/// A mark on an axis; major ones have a label.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    Linear,
    Log,
}

/// A range of numbers and how it is laid out.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    scale: Scale,
    lower: f64,
    upper: f64,
    pub(super) label: String,
}

impl Axis {
    /// From the smallest to the largest of finite `values`, with `margin` of the span on both sides.
    pub(super) fn linear(label: &str, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let (lower, upper) = extremes(values);
        // a constant still needs a range: a tenth of its size, or 1 about zero
        let span = if upper > lower { upper - lower } else { lower.abs().max(10.0) * 0.1 / margin.max(0.05) };
        Axis { scale: Scale::Linear, lower: lower - margin * span, upper: upper + margin * span, label: label.to_owned() }
    }

    /// From the smallest to the largest of positive `values`, `margin` decades wider on both sides; at least one decade.
    pub(super) fn log(label: &str, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let (lower, upper) = extremes(values.into_iter().map(f64::log10));
        let missing = (1.0 - (upper - lower + 2.0 * margin)).max(0.0) / 2.0;
        let margin = margin + missing;
        Axis { scale: Scale::Log, lower: lower - margin, upper: upper + margin, label: label.to_owned() }
    }

    /// Where `value` lies: 0 at the lower end, 1 at the upper.
    pub(super) fn position(&self, value: f64) -> f64 {
        (self.inner(value) - self.lower) / (self.upper - self.lower)
    }

    /// The ends of the axis, as values.
    pub(super) fn ends(&self) -> (f64, f64) {
        match self.scale {
            Scale::Linear => (self.lower, self.upper),
            Scale::Log => (10f64.powf(self.lower), 10f64.powf(self.upper)),
        }
    }

    /// Ticks inside the range; `room` is how many labels fit.
    pub(super) fn ticks(&self, room: usize) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.linear_ticks(room.max(2)),
            Scale::Log => self.log_ticks(room.max(2)),
        }
    }

    fn inner(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.log10(),
        }
    }

    fn linear_ticks(&self, room: usize) -> Vec<Tick> {
        let (step, parts) = nice_step((self.upper - self.lower) / room as f64);
        let small = step / parts as f64;
        let slack = 1e-9 * small;
        let (first, last) = (((self.lower - slack) / small).ceil() as i64, ((self.upper + slack) / small).floor() as i64);
        let largest = self.lower.abs().max(self.upper.abs());
        let tick = |i: i64| {
            let value = i as f64 * small;
            Tick { value, label: (i % parts == 0).then(|| decimal(value, step, largest)) }
        };
        (first..=last).map(tick).collect()
    }

    fn log_ticks(&self, room: usize) -> Vec<Tick> {
        let (first, last) = (self.lower.floor() as i32, self.upper.ceil() as i32);
        let decades = self.upper - self.lower;
        let every = (decades / room as f64).ceil().max(1.0) as i32;
        let inside = |v: f64| (self.lower - 1e-9..=self.upper + 1e-9).contains(&v.log10());
        let mut ticks = Vec::new();
        for e in first..=last {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(e);
                let labelled = match digit {
                    1 => e.rem_euclid(every) == 0,
                    // too few powers of ten in sight to read a value off
                    2 | 5 => decades < 2.0,
                    _ => false,
                };
                // minor ticks are the digits between neighbouring labels, or the powers of ten where those are too many
                if inside(value) && (digit == 1 || every == 1) {
                    ticks.push(Tick { value, label: labelled.then(|| power(digit, e)) });
                }
            }
        }
        ticks
    }
}

fn extremes(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
}

/// The next of 1, 2, 5 × 10ⁿ above `rough`, and into how many parts minor ticks cut it.
fn nice_step(rough: f64) -> (f64, i64) {
    let unit = 10f64.powf(rough.log10().floor());
    match rough / unit {
        r if r <= 1.0 => (unit, 5),
        r if r <= 2.0 => (2.0 * unit, 4),
        r if r <= 5.0 => (5.0 * unit, 5),
        _ => (10.0 * unit, 5),
    }
}

/// `value` with the digits that tell it from its neighbours `step` away.
fn decimal(value: f64, step: f64, largest: f64) -> String {
    let place = step.log10().floor() as i32;
    let magnitude = largest.log10().floor() as i32;
    if !(-4..=5).contains(&magnitude) {
        if value.abs() < 0.5 * step {
            return "0".into();
        }
        let digits = (magnitude - place).max(0) as usize;
        return format!("{}×10{}", minus(&format!("{:.digits$}", value / 10f64.powi(magnitude))), superscript(magnitude));
    }
    let digits = (-place).max(0) as usize;
    // −0.0 prints a sign that means nothing
    minus(&format!("{:.digits$}", if value.abs() < 0.5 * step { 0.0 } else { value }))
}

/// `digit` × 10^`exponent` as read on an axis: 10⁻³, 2×10⁻³; small exponents as plain numbers.
fn power(digit: i32, exponent: i32) -> String {
    match (digit, exponent) {
        (d, 0) => d.to_string(),
        (d, 1) => (10 * d).to_string(),
        (1, e) => format!("10{}", superscript(e)),
        (d, e) => format!("{d}×10{}", superscript(e)),
    }
}

/// `value` with three digits, for a label beside a bar: 0.0123, 4.56×10⁷.
pub(super) fn three_digits(value: f64) -> String {
    // rounding first: 9.996 has its first digit one place further left
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let exponent = if rounded == 0.0 { 0 } else { rounded.abs().log10().floor() as i32 };
    if (-3..=3).contains(&exponent) {
        return minus(&format!("{:.1$}", rounded, (2 - exponent).max(0) as usize));
    }
    format!("{}×10{}", minus(&format!("{:.2}", rounded / 10f64.powi(exponent))), superscript(exponent))
}

fn minus(number: &str) -> String {
    number.replace('-', "−")
}

fn superscript(exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // ⁰ and ⁴ … ⁹ lie in order in their block
        c => char::from_u32(0x2070 + (c as u32 - '0' as u32)).unwrap_or(c),
    };
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, room: usize) -> Vec<String> {
        axis.ticks(room).into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn decades_are_powers_of_ten() {
        let axis = Axis::log("error", [1e-3, 1e2], 0.0);
        assert_eq!(labels(&axis, 8), ["10⁻³", "10⁻²", "10⁻¹", "1", "10", "10²"]);
        assert_eq!(axis.ticks(8).len(), 5 * 9 + 1);
        assert_eq!(labels(&Axis::log("error", [1e-13, 1.0], 0.0), 7), ["10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "1"]);
    }

    #[test]
    fn linear_steps_are_round_and_without_negative_zero() {
        assert_eq!(labels(&Axis::linear("x", [-0.5, 0.5], 0.0), 5), ["−0.4", "−0.2", "0.0", "0.2", "0.4"]);
        assert_eq!(labels(&Axis::linear("x", [0.0, 3e-7], 0.0), 4), ["0", "1×10⁻⁷", "2×10⁻⁷", "3×10⁻⁷"]);
    }

    #[test]
    fn a_constant_has_a_range() {
        for value in [0.0, -3.0, 1e-12, 1e12] {
            let (a, b) = Axis::linear("x", [value], 0.05).ends();
            assert!(a < value && value < b, "{value} in {a}, {b}");
        }
    }

    #[test]
    fn three_digits_round_before_they_are_placed() {
        let cases = [(9.996, "10.0"), (0.0123, "0.0123"), (45_600_000.0, "4.56×10⁷"), (1234.0, "1230"), (-2.5e-9, "−2.50×10⁻⁹")];
        for (value, text) in cases {
            assert_eq!(three_digits(value), text);
        }
    }
}
