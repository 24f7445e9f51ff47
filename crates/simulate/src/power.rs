//! Powers: integer ones by products, |w|^p with the sign of w as a switch, others by their own
//! recurrence.

use crate::compile::{Compiler, Value};
use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::tape::Op;
use lindstedt_equation::{Expression, Function};
use rug::{Float, Rational};

impl<R: Real> Compiler<'_, R> {
    /// base^exponent. |w|^p and (w^(2k))^q are written with |w|: an integer power in all is exact
    /// at w = 0, any other one has a branch point there.
    pub(crate) fn power(
        &mut self,
        base: &Expression,
        exponent: &Expression,
    ) -> Result<Value, SimulateError> {
        let exact = self.rational(exponent);
        let power = match self.expression(exponent) {
            Ok(Value::Constant(power)) => power,
            _ => {
                // exp(exponent ln base).
                let exponent = self.expression(exponent)?;
                let base = self.expression(base)?;
                let ln = self.function(Function::Ln, base);
                let product = self.product(exponent, ln);
                return Ok(self.function(Function::Exp, product));
            }
        };
        if let Some(n) = exact.as_ref().and_then(small_integer) {
            let base = self.expression(base)?;
            return Ok(self.integer_power(base, n));
        }
        let (inner, factor) = match base {
            Expression::Power(inner, k) => {
                match self.rational(k).as_ref().and_then(small_integer) {
                    Some(k) if k % 2 == 0 => (inner, k),
                    _ => (inner, 0),
                }
            }
            Expression::Function(Function::Abs, inner) => (inner, 1),
            _ => (&Box::new(Expression::Time), 0),
        };
        if factor == 0 {
            let base = self.expression(base)?;
            return Ok(self.real_power(base, &power));
        }
        let mut inner = self.expression(inner)?;
        let total = exact.map(|q| q * factor);
        if let Some(n) = total.as_ref().and_then(small_integer) {
            let even = self.integer_power(inner.clone(), n - n.rem_euclid(2));
            if n % 2 == 0 {
                return Ok(even);
            }
            let modulus = self.function(Function::Abs, inner);
            return Ok(self.product(even, modulus));
        }
        let power = power * factor;
        // |c w|^p = |c|^p |w|^p, as for |c w|.
        let mut constant = Value::Constant(self.float(1));
        if let Value::Row(row) = inner {
            let (row, factor) = self.scaled(row).unwrap_or_else(|| (row, self.float(1)));
            constant = self.real_power(Value::Constant(factor.abs()), &power);
            self.switch(row, true);
            inner = Value::Row(row);
        }
        let modulus = self.function(Function::Abs, inner);
        let power = self.real_power(modulus, &power);
        Ok(self.product(constant, power))
    }

    fn real_power(&mut self, base: Value, power: &Float) -> Value {
        match base {
            Value::Constant(base) => Value::Constant(rug::ops::Pow::pow(base, power)),
            Value::Row(row) => {
                let power = self.constant(power);
                Value::Row(self.push(Op::Power(row, power)))
            }
        }
    }

    /// By squarings: exact at zero, at most 2 log2 n products.
    pub(crate) fn integer_power(&mut self, base: Value, n: i32) -> Value {
        let one = Value::Constant(self.float(1));
        let (mut square, mut rest, mut total) = (base, n.unsigned_abs(), one.clone());
        while rest > 0 {
            if rest % 2 == 1 {
                total = self.product(total, square.clone());
            }
            rest /= 2;
            if rest > 0 {
                square = self.product(square.clone(), square);
            }
        }
        if n >= 0 { total } else { self.quotient(one, total) }
    }

    /// x sin(c |x|)/(c |x|) = sin(c x)/c, which has neither a switch nor a quotient 0/0 at x = 0:
    /// takes such factors out of the list and returns their product, 1 if there are none.
    pub(crate) fn removable_quotient(
        &mut self,
        factors: &mut Vec<&Expression>,
    ) -> Result<Value, SimulateError> {
        let one = Value::Constant(self.float(1));
        let minus_one = Some(Rational::from(-1));
        let sine = |e: &&Expression| match *e {
            Expression::Function(Function::Sin, argument) => Some(argument.clone()),
            _ => None,
        };
        for (first, argument) in factors.iter().enumerate().filter_map(|(i, e)| Some((i, sine(e)?)))
        {
            let reciprocal = |e: &&Expression| match e {
                Expression::Power(base, exponent) => {
                    *base == argument && self.rational(exponent) == minus_one
                }
                _ => false,
            };
            let Some(second) = factors.iter().position(reciprocal) else { continue };
            let known = (self.tape.ops.len(), self.switches.len());
            let Value::Row(row) = self.expression(&argument)? else { continue };
            let op = |row: usize| row.checked_sub(self.tape.states).map(|i| self.tape.ops[i]);
            let (scale, row) = match op(row) {
                Some(Op::Scale(inner, c)) => (self.tape.constants[c].clone(), inner),
                _ => (self.real.double(1.0), row),
            };
            let Some(Op::Signed(inner, _)) = op(row) else { continue };
            for third in (0..factors.len()).filter(|third| *third != first && *third != second) {
                let Value::Row(other) = self.expression(factors[third])? else { continue };
                if other != inner {
                    continue;
                }
                // |x| itself is not needed any more.
                if inner < self.tape.states + known.0 {
                    self.tape.ops.truncate(known.0);
                    self.tape.affine.truncate(known.0);
                    self.switches.truncate(known.1);
                }
                let scale = self.real.to_float(&scale);
                let angle = self.product(Value::Constant(scale.clone()), Value::Row(inner));
                let angle = self.row(angle);
                let sine = Value::Row(self.sine(angle));
                let mut gone = [first, second, third];
                gone.sort_unstable();
                for index in gone.into_iter().rev() {
                    factors.remove(index);
                }
                return Ok(self.product(sine, Value::Constant(scale.recip())));
            }
        }
        Ok(one)
    }

    /// w^m |w|^q with integers m and q < 0, without 0/0 at w = 0: w^(m+q), times the sign of w for
    /// odd q. Takes such factors out of the list and returns their product, 1 if there are none.
    pub(crate) fn modulus_quotient(
        &mut self,
        factors: &mut Vec<&Expression>,
    ) -> Result<Value, SimulateError> {
        let one = Value::Constant(self.float(1));
        let found = factors.iter().find_map(|factor| match factor {
            Expression::Power(base, exponent) => {
                let exponent = self.rational(exponent)?;
                let (inner, k) = match &**base {
                    Expression::Power(inner, k) => (inner, small_integer(&self.rational(k)?)?),
                    Expression::Function(Function::Abs, inner) => (inner, 1),
                    _ => return None,
                };
                let modulus = k == 1 || k % 2 == 0;
                let total = small_integer(&(exponent * k)).filter(|q| modulus && *q < 0)?;
                Some(((**inner).clone(), *factor, total))
            }
            _ => None,
        });
        let Some((inner, modulus, mut total)) = found else { return Ok(one) };
        let odd = total % 2 != 0;
        let own = |this: &Self, factor: &Expression| match factor {
            factor if *factor == inner => Some(1),
            Expression::Power(base, m) if **base == inner => small_integer(&this.rational(m)?),
            _ => None,
        };
        let (mut rest, mut taken) = (Vec::new(), false);
        for factor in factors.iter().copied() {
            if std::ptr::eq(factor, modulus) {
                continue;
            }
            match own(self, factor).and_then(|m| total.checked_add(m)) {
                Some(sum) => (total, taken) = (sum, true),
                None => rest.push(factor),
            }
        }
        if !taken {
            return Ok(one);
        }
        *factors = rest;
        let inner = self.expression(&inner)?;
        if !odd {
            return Ok(self.integer_power(inner, total));
        }
        let (sign, power) =
            if total > 0 { (Function::Abs, total - 1) } else { (Function::Sign, total) };
        let power = self.integer_power(inner.clone(), power);
        let sign = self.function(sign, inner);
        Ok(self.product(power, sign))
    }

    /// c w of an expression c w^n with odd n > 1.
    pub(crate) fn odd_root(&self, expression: &Expression) -> Option<Expression> {
        match expression {
            Expression::Power(base, n) => {
                let n = small_integer(&self.rational(n)?).filter(|n: &i32| *n > 1 && n % 2 == 1);
                n.map(|_| self.odd_root(base).unwrap_or((**base).clone()))
            }
            Expression::Product(factors) => {
                let mut moving = factors.iter().filter(|factor| !self.is_constant(factor));
                let (Some(w), None) = (moving.next(), moving.next()) else { return None };
                let root = self.odd_root(w)?;
                let constants = factors.iter().filter(|factor| self.is_constant(factor)).cloned();
                Some(Expression::Product(constants.chain([root]).collect()))
            }
            _ => None,
        }
    }

    /// The value of a constant expression, if it is rational.
    fn rational(&self, expression: &Expression) -> Option<Rational> {
        match expression {
            Expression::Number(q) => Some(q.clone()),
            Expression::Parameter(name) if !self.names.contains(name) => {
                self.parameters.get(name)?.rational()
            }
            Expression::Small => self.parameters.get(self.small?)?.rational(),
            Expression::Sum(terms) => terms.iter().map(|term| self.rational(term)).sum(),
            Expression::Product(factors) => factors.iter().map(|f| self.rational(f)).product(),
            Expression::Power(base, exponent) => {
                let n = small_integer(&self.rational(exponent)?)?;
                let base = self.rational(base)?;
                (n >= 0 || base.cmp0().is_ne()).then(|| rug::ops::Pow::pow(base, n))
            }
            _ => None,
        }
    }
}

/// An integer exponent of at most 10^6.
fn small_integer(q: &Rational) -> Option<i32> {
    q.is_integer().then(|| q.numer().to_i32()).flatten().filter(|n| n.abs() <= 1_000_000)
}
