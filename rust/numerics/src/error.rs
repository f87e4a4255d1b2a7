//! Errors about arguments, which name the argument, the rule and the value.

use std::borrow::Cow;
use std::fmt;

/// The family of a failure: which Python exception it becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The value itself is wrong: not finite, negative, unknown, of the wrong length.
    Value,
    /// The motion is well formed, but this rover cannot make it without side slip.
    Infeasible,
    /// The readings do not determine the twist.
    Underdetermined,
    /// The request does not fit into memory.
    Memory,
    /// The caller ended the call before it was through.
    Interrupted,
}

/// "`argument` must `rule`, got `value`": the text of every failure of this crate.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// Exception family.
    pub kind: ErrorKind,
    /// Name of the argument at fault.
    pub argument: Cow<'static, str>,
    /// Row of a batch, counted over the flattened leading axes.
    pub row: Option<usize>,
    /// Rule that the argument must meet.
    pub rule: String,
    /// Value that came instead.
    pub value: String,
}

impl Error {
    /// A wrong value.
    #[cold]
    #[inline(never)] // calls that succeed stay small
    pub fn value(argument: impl Into<Cow<'static, str>>, rule: impl ToString, value: impl ToString) -> Self {
        let (rule, value) = (rule.to_string(), value.to_string());
        Self { kind: ErrorKind::Value, argument: argument.into(), row: None, rule, value }
    }

    /// The failure of a call that its caller interrupted.
    pub fn interrupted() -> Self {
        Self::value("call", "not be interrupted", "an interruption").of_kind(ErrorKind::Interrupted)
    }

    /// The same failure, of another kind.
    #[must_use]
    #[inline]
    pub fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.kind = kind;
        self
    }

    /// The same failure, found in this row of a batch.
    #[must_use]
    #[inline]
    pub fn at_row(mut self, row: usize) -> Self {
        self.row = Some(row);
        self
    }

    /// The same failure, found in rows that begin with this row of a batch.
    #[must_use]
    #[inline]
    pub fn below(mut self, first: usize) -> Self {
        self.row = self.row.map(|row| first + row);
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.row.map_or_else(String::new, |row| format!("[{row}]"));
        write!(f, "{}{place} must {}, got {}", self.argument, self.rule, self.value)
    }
}

impl std::error::Error for Error {}

/// A number as Python writes it.
pub fn number(value: f64) -> String {
    if value.is_nan() { "nan".into() } else { format!("{value:?}") }
}

/// Four digits of a number, as Python writes it, for messages.
pub fn short(value: f64) -> String {
    number(format!("{value:.3e}").parse().unwrap_or(value))
}

/// An angle [rad] in both units.
pub fn radians(angle: f64) -> String {
    format!("{} rad ({:.1}°)", short(angle), angle.to_degrees())
}

/// A number, or a tuple of several, as Python writes it.
pub fn numbers(values: &[f64]) -> String {
    if let [value] = values {
        return number(*value);
    }
    let inner: Vec<String> = values.iter().copied().map(number).collect();
    format!("({})", inner.join(", "))
}

/// Numbers of a state, and lengths of a rover, from which on sums of their squares might not be finite.
pub const HUGE: f64 = 1e60;

/// Limits and radii up to this are refused: quotients by them may not be finite.
pub const TINY: f64 = 1e-60;

/// Numbers of this size and above are refused where their squares enter a result, which would not be finite.
pub const LARGEST: f64 = 1e150;

/// Durations below this are refused where a result is divided by them.
pub const SHORTEST: f64 = 1e-150;

/// Fails unless every value is finite and smaller than [`LARGEST`].
pub fn bounded(argument: &'static str, values: &[f64]) -> Result<(), Error> {
    finite(argument, values)?;
    match values.iter().all(|value| value.abs() < LARGEST) {
        true => Ok(()),
        false => Err(Error::value(argument, format!("be smaller than {LARGEST:e}"), numbers(values))),
    }
}

/// Fails unless every value is finite.
pub fn finite(argument: &'static str, values: &[f64]) -> Result<(), Error> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(Error::value(argument, "be finite", numbers(values)))
    }
}

/// Fails unless the value is finite and positive.
pub fn positive(argument: impl Into<Cow<'static, str>>, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::value(argument, "be finite and positive", number(value)))
    }
}

/// Fails unless the value is finite and not negative.
pub fn not_negative(argument: impl Into<Cow<'static, str>>, value: f64) -> Result<(), Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(Error::value(argument, "be finite and not negative", number(value)))
    }
}
