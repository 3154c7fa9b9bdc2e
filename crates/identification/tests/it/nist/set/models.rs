//! The models of the 27 problems with their derivatives, in the notation of the NIST files.

use std::f64::consts::PI;

/// Value at parameters `b` and predictors `x`; writes d value / d b.
pub(crate) type Model = fn(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64;

/// File name and model of every problem.
pub(crate) const MODELS: [(&str, Model); 27] = [
    ("Bennett5", bennett5),
    ("BoxBOD", saturation),
    ("Chwirut1", chwirut),
    ("Chwirut2", chwirut),
    ("DanWood", power),
    ("ENSO", enso),
    ("Eckerle4", eckerle4),
    ("Gauss1", gauss),
    ("Gauss2", gauss),
    ("Gauss3", gauss),
    ("Hahn1", rational::<3, 3>),
    ("Kirby2", rational::<2, 2>),
    ("Lanczos1", lanczos),
    ("Lanczos2", lanczos),
    ("Lanczos3", lanczos),
    ("MGH09", mgh09),
    ("MGH10", mgh10),
    ("MGH17", mgh17),
    ("Misra1a", saturation),
    ("Misra1b", misra1b),
    ("Misra1c", misra1c),
    ("Misra1d", misra1d),
    ("Nelson", nelson),
    ("Rat42", rat42),
    ("Rat43", rat43),
    ("Roszman1", roszman1),
    ("Thurber", rational::<3, 3>),
];

/// b1 (b2 + x)^(-1/b3)
fn bennett5(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let base = b[1] + x[0];
    let power = base.powf(-1.0 / b[2]);
    slopes[0] = power;
    slopes[1] = -b[0] / b[2] * power / base;
    slopes[2] = b[0] * power * base.ln() / (b[2] * b[2]);
    b[0] * power
}

/// b1 (1 - exp(-b2 x))
fn saturation(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let decay = (-b[1] * x[0]).exp();
    slopes[0] = 1.0 - decay;
    slopes[1] = b[0] * x[0] * decay;
    b[0] * (1.0 - decay)
}

/// exp(-b1 x) / (b2 + b3 x)
fn chwirut(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let bottom = b[1] + b[2] * x[0];
    let value = (-b[0] * x[0]).exp() / bottom;
    slopes[0] = -x[0] * value;
    slopes[1] = -value / bottom;
    slopes[2] = -value * x[0] / bottom;
    value
}

/// b1 x^b2
fn power(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let power = x[0].powf(b[1]);
    slopes[0] = power;
    slopes[1] = b[0] * power * x[0].ln();
    b[0] * power
}

/// A constant and three cycles, one of 12 months and two of periods b4 and b7.
fn enso(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let t = x[0];
    let (annual_sine, annual_cosine) = (2.0 * PI * t / 12.0).sin_cos();
    slopes[0] = 1.0;
    slopes[1] = annual_cosine;
    slopes[2] = annual_sine;
    let mut value = b[0] + b[1] * annual_cosine + b[2] * annual_sine;
    for first in [3, 6] {
        let period = b[first];
        let (sine, cosine) = (2.0 * PI * t / period).sin_cos();
        value += b[first + 1] * cosine + b[first + 2] * sine;
        slopes[first] =
            2.0 * PI * t / (period * period) * (b[first + 1] * sine - b[first + 2] * cosine);
        slopes[first + 1] = cosine;
        slopes[first + 2] = sine;
    }
    value
}

/// (b1/b2) exp(-((x - b3)/b2)^2 / 2)
fn eckerle4(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let distance = (x[0] - b[2]) / b[1];
    let bell = (-0.5 * distance * distance).exp();
    slopes[0] = bell / b[1];
    slopes[1] = b[0] * bell * (distance * distance - 1.0) / (b[1] * b[1]);
    slopes[2] = b[0] * bell * distance / (b[1] * b[1]);
    b[0] / b[1] * bell
}

/// b1 exp(-b2 x) + b3 exp(-(x - b4)^2/b5^2) + b6 exp(-(x - b7)^2/b8^2)
fn gauss(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let decay = (-b[1] * x[0]).exp();
    slopes[0] = decay;
    slopes[1] = -b[0] * x[0] * decay;
    let mut value = b[0] * decay;
    for first in [2, 5] {
        let distance = (x[0] - b[first + 1]) / b[first + 2];
        let bell = (-distance * distance).exp();
        value += b[first] * bell;
        slopes[first] = bell;
        slopes[first + 1] = 2.0 * b[first] * bell * distance / b[first + 2];
        slopes[first + 2] = 2.0 * b[first] * bell * distance * distance / b[first + 2];
    }
    value
}

/// (b1 + b2 x + ...) / (1 + ... x + ...), of degrees `TOP` and `BOTTOM`.
fn rational<const TOP: usize, const BOTTOM: usize>(
    b: &[f64],
    x: &[f64],
    slopes: &mut [f64],
) -> f64 {
    let horner = |coefficients: &[f64]| {
        coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, coefficient| sum * x[0] + coefficient)
    };
    let top = horner(&b[..=TOP]);
    let bottom = 1.0 + x[0] * horner(&b[TOP + 1..]);
    let mut power = 1.0;
    for slope in &mut slopes[..=TOP] {
        *slope = power / bottom;
        power *= x[0];
    }
    power = 1.0;
    for slope in &mut slopes[TOP + 1..][..BOTTOM] {
        power *= x[0];
        *slope = -top * power / (bottom * bottom);
    }
    top / bottom
}

/// b1 exp(-b2 x) + b3 exp(-b4 x) + b5 exp(-b6 x)
fn lanczos(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let mut value = 0.0;
    for first in [0, 2, 4] {
        let decay = (-b[first + 1] * x[0]).exp();
        value += b[first] * decay;
        slopes[first] = decay;
        slopes[first + 1] = -b[first] * x[0] * decay;
    }
    value
}

/// b1 (x^2 + x b2) / (x^2 + x b3 + b4)
fn mgh09(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let x = x[0];
    let (top, bottom) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
    slopes[0] = top / bottom;
    slopes[1] = b[0] * x / bottom;
    slopes[2] = -b[0] * top * x / (bottom * bottom);
    slopes[3] = -b[0] * top / (bottom * bottom);
    b[0] * top / bottom
}

/// b1 exp(b2 / (x + b3))
fn mgh10(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let distance = x[0] + b[2];
    let growth = (b[1] / distance).exp();
    slopes[0] = growth;
    slopes[1] = b[0] * growth / distance;
    slopes[2] = -b[0] * growth * b[1] / (distance * distance);
    b[0] * growth
}

/// b1 + b2 exp(-x b4) + b3 exp(-x b5)
fn mgh17(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let (slow, fast) = ((-x[0] * b[3]).exp(), (-x[0] * b[4]).exp());
    slopes.copy_from_slice(&[1.0, slow, fast, -b[1] * x[0] * slow, -b[2] * x[0] * fast]);
    b[0] + b[1] * slow + b[2] * fast
}

/// b1 (1 - (1 + b2 x/2)^-2)
fn misra1b(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let base = 1.0 + b[1] * x[0] / 2.0;
    slopes[0] = 1.0 - base.powi(-2);
    slopes[1] = b[0] * x[0] * base.powi(-3);
    b[0] * (1.0 - base.powi(-2))
}

/// b1 (1 - (1 + 2 b2 x)^-0.5)
fn misra1c(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let base = 1.0 + 2.0 * b[1] * x[0];
    slopes[0] = 1.0 - base.powf(-0.5);
    slopes[1] = b[0] * x[0] * base.powf(-1.5);
    b[0] * (1.0 - base.powf(-0.5))
}

/// b1 b2 x / (1 + b2 x)
fn misra1d(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let bottom = 1.0 + b[1] * x[0];
    slopes[0] = b[1] * x[0] / bottom;
    slopes[1] = b[0] * x[0] / (bottom * bottom);
    b[0] * b[1] * x[0] / bottom
}

/// b1 - b2 x1 exp(-b3 x2), a model of log(y)
fn nelson(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let decay = (-b[2] * x[1]).exp();
    slopes[0] = 1.0;
    slopes[1] = -x[0] * decay;
    slopes[2] = b[1] * x[0] * x[1] * decay;
    b[0] - b[1] * x[0] * decay
}

/// b1 / (1 + exp(b2 - b3 x))
fn rat42(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let growth = (b[1] - b[2] * x[0]).exp();
    let bottom = 1.0 + growth;
    slopes[0] = 1.0 / bottom;
    slopes[1] = -b[0] * growth / (bottom * bottom);
    slopes[2] = b[0] * growth * x[0] / (bottom * bottom);
    b[0] / bottom
}

/// b1 / (1 + exp(b2 - b3 x))^(1/b4)
fn rat43(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let growth = (b[1] - b[2] * x[0]).exp();
    let bottom = 1.0 + growth;
    let value = b[0] * bottom.powf(-1.0 / b[3]);
    slopes[0] = value / b[0];
    slopes[1] = -value / b[3] * growth / bottom;
    slopes[2] = value / b[3] * growth / bottom * x[0];
    slopes[3] = value * bottom.ln() / (b[3] * b[3]);
    value
}

/// b1 - b2 x - arctan(b3 / (x - b4)) / pi
fn roszman1(b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
    let distance = x[0] - b[3];
    let square = distance * distance + b[2] * b[2];
    slopes[0] = 1.0;
    slopes[1] = -x[0];
    slopes[2] = -distance / square / PI;
    slopes[3] = -b[2] / square / PI;
    b[0] - b[1] * x[0] - (b[2] / distance).atan() / PI
}
