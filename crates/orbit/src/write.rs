//! Numbers of a proof as data: a ball is its midpoint and its radius.

use lindstedt_number::ball::Ball;
use rug::Float;
use rug::float::Round;
use serde::Serializer;
use serde::ser::SerializeStruct;

/// Decimal digits of a radius; it is rounded up.
const RADIUS_DIGITS: usize = 6;

/// A bound, rounded up.
pub(crate) fn float<S: Serializer>(x: &Float, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&x.to_string_radix_round(10, Some(RADIUS_DIGITS), Round::Up))
}

/// {"midpoint", "radius"}: as many decimals as the midpoint's bits need to be read back, so that
/// the decimal stands for the midpoint at its precision; the radius rounded up.
pub(crate) fn ball<S: Serializer>(ball: &Ball, to: S) -> Result<S::Ok, S::Error> {
    let mut pair = to.serialize_struct("Ball", 2)?;
    pair.serialize_field("midpoint", &ball.midpoint().to_string_radix(10, None))?;
    let radius = ball.radius().to_string_radix_round(10, Some(RADIUS_DIGITS), Round::Up);
    pair.serialize_field("radius", &radius)?;
    pair.end()
}
