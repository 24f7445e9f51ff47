//! The stick-slip oscillator: the [`System`] of the double well, one harmonic, dry and cubic friction, whose threshold, cusp and
//! zeros have closed forms.

use crate::error::positive;
use crate::root::{enclose_root, sqrt_positive_part};
use crate::{
    Factor, Forcing, Friction, MelnikovError, PolynomialFriction, Potential, StickSlip, System,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};

impl StickSlip {
    /// The closed form of a system; nothing where it is another one.
    #[must_use]
    pub fn of(system: &System) -> Option<Self> {
        let Potential::DoubleWell { a, b } = system.potential() else { return None };
        let Friction::Polynomial(law) = system.friction() else { return None };
        let Forcing::Harmonics { omega, harmonics } = system.forcing() else { return None };
        let [only] = harmonics.as_slice() else { return None };
        let plain = only.number == 1 && only.weight == Exact::from(1) && only.factor == Factor::ONE;
        if !(plain && system.damping().is_empty()) {
            return None;
        }
        let t = |k: usize| law.coefficients.get(k).cloned().unwrap_or_else(|| Exact::from(0));
        let mut rest = (0..law.coefficients.len()).filter(|k| *k != 1 && *k != 3);
        rest.all(|k| t(k).sign().is_eq()).then(|| Self {
            a: a.clone(),
            b: b.clone(),
            dry: law.dry.clone(),
            alpha: -&t(1),
            beta: t(3),
            omega: omega.clone(),
            belt_speed: system.belt_speed().clone(),
        })
    }

    /// Domain: a, b, omega > 0.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`] with the name.
    pub fn check(&self) -> Result<(), MelnikovError> {
        positive(&self.a, "a")?;
        positive(&self.b, "b")?;
        positive(&self.omega, "omega")
    }

    /// The system.
    ///
    /// # Errors
    /// Those of [`System::new`].
    pub fn system(&self) -> Result<System, MelnikovError> {
        let law = PolynomialFriction::cubic(self.dry.clone(), &self.alpha, self.beta.clone());
        System::new(
            self.potential(),
            Friction::Polynomial(law),
            Forcing::single(self.omega.clone()),
            self.belt_speed.clone(),
        )
    }

    /// The double well.
    #[must_use]
    pub fn potential(&self) -> Potential {
        Potential::DoubleWell { a: self.a.clone(), b: self.b.clone() }
    }

    /// V = a/sqrt(2b): the largest speed on the loop and the place of the cusp.
    #[must_use]
    pub fn loop_speed(&self, balls: Balls) -> Option<Ball> {
        self.potential().largest_speed(balls)
    }

    /// G = 2 T0 sqrt(1 - |v*|/V)_+ - (4/3) V (alpha - 3 beta v*^2) + (32/35) beta V^3; the work of
    /// friction is D = sqrt(2a/b) G.
    ///
    /// 1 - |v*|/V is formed without cancellation, so at |v*| = V the digits stay.
    #[must_use]
    pub fn g(&self, balls: Balls) -> Option<Ball> {
        let v = self.loop_speed(balls)?;
        let gap = self.potential().speed_gap(balls, &self.belt_speed)?;
        let dry = balls.mul(&self.dry.ball(balls), &sqrt_positive_part(balls, &gap)?);
        let smooth = self.smooth(balls, &v, &self.belt_speed_squared(balls))?;
        Some(balls.add(&balls.mul_power_of_two(&dry, 1), &balls.mul(&v, &smooth)))
    }

    /// v*^2, and the rational number that it is.
    fn belt_speed_squared(&self, balls: Balls) -> (Ball, Option<Rational>) {
        let exact = self.belt_speed.as_rational().map(|v| Rational::from(v.square_ref()));
        (balls.square(&self.belt_speed.ball(balls)), exact)
    }

    /// V^2 = a^2/(2b) where it is rational.
    fn loop_speed_squared(&self) -> Option<Rational> {
        let (a, b) = (self.a.as_rational()?, self.b.as_rational()?);
        let twice = Rational::from(b * 2u32);
        (!twice.is_zero()).then(|| Rational::from(a.square_ref()) / twice)
    }

    /// (32/35) beta V^2 - (4/3)(alpha - 3 beta s) at s = v*^2, the smooth part of G/V. Formed over
    /// Q where the parameters are rational, so that an exact zero is one.
    fn smooth(&self, balls: Balls, v: &Ball, s: &(Ball, Option<Rational>)) -> Option<Ball> {
        let (cubic, linear) = (Rational::from((32, 35)), Rational::from((4, 3)));
        if let (Some(square), Some(s)) = (self.loop_speed_squared(), &s.1)
            && let (Some(alpha), Some(beta)) = (self.alpha.as_rational(), self.beta.as_rational())
        {
            let slope = alpha - Rational::from(beta * s) * 3u32;
            return Some(balls.from_rational(&(square * beta * cubic - slope * linear)));
        }
        let beta = self.beta.ball(balls);
        let slope = balls.sub(&self.alpha.ball(balls), &balls.mul_i64(&balls.mul(&beta, &s.0), 3));
        let cubic = balls.mul_rational(&balls.mul(&beta, &balls.square(v)), &cubic);
        Some(balls.sub(&cubic, &balls.mul_rational(&slope, &linear)))
    }

    /// The smooth part of G/V at |v*| = V.
    fn smooth_at_cusp(&self, balls: Balls, v: &Ball) -> Option<Ball> {
        self.smooth(balls, v, &(balls.square(v), self.loop_speed_squared()))
    }

    /// D/F = G cosh(z)/(2z) with z = pi omega/(2 sqrt a). gamma_c is its absolute value.
    #[must_use]
    pub fn signed_threshold(&self, balls: Balls) -> Option<Ball> {
        self.forced(balls, &self.g(balls)?)
    }

    /// g cosh(z)/(2z).
    fn forced(&self, balls: Balls, g: &Ball) -> Option<Ball> {
        let root = balls.sqrt(&self.a.ball(balls))?;
        let twice = balls.div(&balls.mul(&balls.pi(), &self.omega.ball(balls)), &root)?;
        let cosh = balls.cosh(&balls.mul_power_of_two(&twice, -1));
        balls.div(&balls.mul(g, &cosh), &twice)
    }

    /// The signed threshold at the cusp |v*| = V, where the dry term has just vanished:
    /// ((172/35) beta V^2 - (4/3) alpha) V cosh(z)/(2z).
    #[must_use]
    pub fn threshold_at_cusp(&self, balls: Balls) -> Option<Ball> {
        let v = self.loop_speed(balls)?;
        let g = balls.mul(&v, &self.smooth_at_cusp(balls, &v)?);
        self.forced(balls, &g)
    }

    /// The threshold as a formula with the numbers of this point, where the parameters are
    /// rational.
    #[must_use]
    pub fn exact_threshold(&self) -> Option<String> {
        let rational = Exact::as_rational;
        let (a, b) = (rational(&self.a)?, rational(&self.b)?);
        let (alpha, beta) = (rational(&self.alpha)?, rational(&self.beta)?);
        let v = rational(&self.belt_speed)?;
        let square = Rational::from(a.square_ref()) / Rational::from(b * 2u32);
        let speed = Rational::from(v.square_ref());
        let inside = speed < square;
        // G/V = (32/35) beta V^2 - (4/3)(alpha - 3 beta v*^2).
        let smooth = Rational::from(beta * &square) * Rational::from((32, 35))
            - Rational::from((4, 3)) * (alpha - Rational::from(beta * &speed) * 3u32);
        let v_abs = Rational::from(v.abs_ref());
        let mut g = format!("({smooth})*sqrt({square})");
        if inside && self.dry.sign().is_ne() {
            g = format!("2*({})*sqrt(1 - ({v_abs})/sqrt({square})) + {g}", self.dry);
        }
        let omega = &self.omega;
        Some(format!("abs({g})*sqrt({a})*cosh(pi*({omega})/(2*sqrt({a})))/(pi*({omega}))"))
    }

    /// b* = 129 a^2 beta/(70 alpha), where the cusp at |v*| = V touches gamma = 0 (V^2 =
    /// 35 alpha/(129 beta)): exact. `None` unless a, alpha, beta are rational and b* > 0.
    ///
    /// Derived: at |v*| = V, G/V = (32/35 + 4) beta V^2 - (4/3) alpha = (172/35) beta V^2 - (4/3) alpha.
    #[must_use]
    pub fn touching_b(&self) -> Option<Rational> {
        let (a, alpha, beta) =
            (self.a.as_rational()?, self.alpha.as_rational()?, self.beta.as_rational()?);
        if alpha.is_zero() {
            return None;
        }
        // The coefficient of beta V^2 and that of alpha, from G at v*^2 = V^2.
        let cubic = Rational::from((32, 35)) + Rational::from((4, 3)) * 3u32;
        let linear = Rational::from((4, 3));
        // beta V^2 cubic = alpha linear with V^2 = a^2/(2b).
        let b = Rational::from(a.square_ref()) * beta * cubic / (linear * alpha * 2u32);
        (b > 0).then_some(b)
    }

    /// All zeros of G in v* >= 0, ascending, certified and complete.
    ///
    /// Inside |v*| < V: with z = sqrt(1 - |v*|/V) the roots in (0, 1) of
    /// 4 beta V^3 z^4 - 8 beta V^3 z^2 + 2 T0 z + (172/35) beta V^3 - (4/3) alpha V,
    /// isolated by the monotone pieces between the roots of its derivatives. Outside:
    /// v*^2 = alpha/(3 beta) - (8/35) V^2 where that is at least V^2. G is even in v*.
    ///
    /// For alpha = beta = 0 (dry friction alone) G vanishes for all |v*| >= V; V is returned.
    ///
    /// # Errors
    /// [`MelnikovError::IdenticallyZero`] without friction,
    /// [`MelnikovError::Undecided`] where a sign at the end of a monotone piece is not decided at
    /// this precision (a double zero, a zero at 0; a zero at V unless a, b, alpha, beta are
    /// rational).
    pub fn zeros(&self, balls: Balls) -> Result<Vec<Ball>, MelnikovError> {
        self.check()?;
        if [&self.dry, &self.alpha, &self.beta].iter().all(|x| x.sign().is_eq()) {
            return Err(MelnikovError::IdenticallyZero);
        }
        self.try_zeros(balls).ok_or(MelnikovError::Undecided { bits: balls.bits() })
    }

    fn try_zeros(&self, balls: Balls) -> Option<Vec<Ball>> {
        let v = self.loop_speed(balls)?;
        let quartic = self.quartic(balls, &v)?;
        let mut zeros = Vec::new();
        // z falls as |v*| rises.
        for z in unit_roots(balls, &quartic)?.iter().rev() {
            let fraction = balls.sub(&balls.one(), &balls.square(z));
            zeros.push(balls.mul(&v, &fraction));
        }
        let [constant, ..] = quartic;
        if constant.is_exact() && constant.contains_zero() {
            // The cusp lies on gamma = 0, and so does the end of the outer branch.
            if self.beta.sign().is_ne() || self.dry.sign().is_ne() {
                zeros.push(v);
            }
            return Some(zeros);
        }
        if self.beta.sign().is_ne() {
            // G/V = 4 beta (v*^2 - V^2) + constant outside: v*^2 = V^2 - constant/(4 beta) =
            // alpha/(3 beta) - (8/35) V^2.
            let excess = balls.div(&constant, &balls.mul_i64(&self.beta.ball(balls), -4))?;
            if excess.is_positive() {
                zeros.push(balls.sqrt(&balls.add(&balls.square(&v), &excess))?);
            } else if !excess.is_negative() {
                return None;
            }
        }
        Some(zeros)
    }

    /// The coefficients of z^0 ... z^4 of the quartic of [`StickSlip::zeros`], divided by V.
    fn quartic(&self, balls: Balls, v: &Ball) -> Option<[Ball; 5]> {
        let cubic = balls.mul(&self.beta.ball(balls), &balls.square(v));
        let constant = self.smooth_at_cusp(balls, v)?;
        let dry = balls.div(&balls.mul_power_of_two(&self.dry.ball(balls), 1), v)?;
        Some([constant, dry, balls.mul_i64(&cubic, -8), balls.zero(), balls.mul_i64(&cubic, 4)])
    }

    /// The smooth stationary points of G in 0 < v* < V: y^2 (1 - y) = (T0/(8 beta V^3))^2, where
    /// T0/beta > 0. Ascending; none, or two where V^3 > sqrt(27) T0/(16 beta).
    ///
    /// # Errors
    /// As for [`StickSlip::zeros`].
    pub fn stationary_points(&self, balls: Balls) -> Result<Vec<Ball>, MelnikovError> {
        self.check()?;
        let roots = || -> Option<Vec<Ball>> {
            let v = self.loop_speed(balls)?;
            if self.beta.sign() != self.dry.sign() || self.beta.sign().is_eq() {
                return Some(Vec::new());
            }
            let cubic = balls.mul(&self.beta.ball(balls), &balls.powi(&v, 3)?);
            let ratio = balls.div(&self.dry.ball(balls), &balls.mul_i64(&cubic, 8))?;
            let right = balls.neg(&balls.square(&ratio));
            let minus = balls.from_i64(-1);
            let roots = unit_roots(balls, &[right, balls.zero(), balls.one(), minus])?;
            Some(roots.iter().map(|y| balls.mul(&v, y)).collect())
        };
        roots().ok_or(MelnikovError::Undecided { bits: balls.bits() })
    }
}

/// All roots in the open interval (0, 1), ascending, of a polynomial with ball coefficients;
/// complete: between two neighbouring roots of the derivative the polynomial is monotone.
/// `None` where a sign at the end of such a piece is not decided.
fn unit_roots(balls: Balls, coefficients: &[Ball]) -> Option<Vec<Ball>> {
    let exactly_zero = |c: &Ball| c.is_exact() && c.contains_zero();
    let mut degree = coefficients.len();
    while degree > 0 && exactly_zero(&coefficients[degree - 1]) {
        degree -= 1;
    }
    let coefficients = &coefficients[..degree];
    if degree <= 1 {
        return Some(Vec::new());
    }
    let value = |balls: Balls, z: &Ball| {
        Some(
            coefficients
                .iter()
                .rev()
                .fold(balls.zero(), |sum, c| balls.add(&balls.mul(&sum, z), c)),
        )
    };
    let powers = (1i64..).zip(&coefficients[1..]);
    let derivative: Vec<Ball> = powers.map(|(k, c)| balls.mul_i64(c, k)).collect();
    let float = |x: i64| Float::with_val(balls.bits(), x);
    let exact = |x: &Float| balls.from_parts(x, &Float::new(53));
    let mut roots = Vec::new();
    // A factor z: its root 0 is not in the open interval; go on with the quotient.
    if exactly_zero(&coefficients[0]) {
        return unit_roots(balls, &coefficients[1..]);
    }
    let mut pieces = vec![(float(0), float(0))];
    for critical in unit_roots(balls, &derivative)? {
        pieces.push((critical.lower(), critical.upper()));
    }
    pieces.push((float(1), float(1)));
    for pair in pieces.windows(2) {
        let [left, right] = pair else { continue };
        // The sign must not change within the enclosure of a stationary point.
        let at = |(low, high): &(Float, Float)| -> Option<bool> {
            let hull = value(balls, &balls.hull(&exact(low), &exact(high)))?;
            match (hull.is_positive(), hull.is_negative()) {
                (true, _) => Some(true),
                (_, true) => Some(false),
                _ => None,
            }
        };
        if at(left)? != at(right)? {
            roots.push(enclose_root(balls, &left.1, &right.0, value)?);
        }
    }
    Some(roots)
}
