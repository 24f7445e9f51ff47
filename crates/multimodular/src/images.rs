//! A growing list of images, all of one form.

use crate::Error;
use crate::image::{Attempt, Image, Job};
use lindstedt_expand::ExpandError;
use lindstedt_phase::modular::{LANES, PrimeFields};
use rayon::prelude::*;

/// The images so far, and the primes that are left. The first image judges what the others give.
pub(crate) struct Images<'a, P> {
    pub job: &'a Job<'a>,
    pub list: Vec<Image>,
    primes: P,
}

impl<'a, P: Iterator<Item = PrimeFields>> Images<'a, P> {
    pub(crate) fn new(job: &'a Job<'a>, primes: P) -> Self {
        Self { job, list: Vec::new(), primes }
    }

    /// At least so many more images, made by `image` eight primes at a time; `observer` is told how many primes there
    /// are.
    pub(crate) fn more(
        &mut self,
        count: usize,
        image: &(dyn Fn(PrimeFields) -> Attempt + Sync),
        observer: &mut dyn FnMut(usize) -> bool,
    ) -> Result<(), Error> {
        let wanted = self.list.len() + count;
        while self.list.len() < wanted {
            let missing = wanted - self.list.len();
            let fields: Vec<PrimeFields> =
                self.primes.by_ref().take(missing.div_ceil(LANES / 2)).collect();
            if fields.is_empty() {
                return Err(Error::OutOfPrimes);
            }
            let new: Vec<_> = fields.into_par_iter().map(image).collect();
            // A prime can be unlucky (a denominator or a pivot vanishes modulo it): it is skipped. What
            // fails modulo all of them fails over Q.
            let mut failure = None;
            for image in new {
                match image? {
                    Ok(group) => {
                        for image in group {
                            let image = match self.list.first() {
                                // A coefficient vanishes modulo eight primes and not over Q.
                                Some(judge) => image.like(judge).ok_or(Error::OutOfPrimes)?,
                                None => image,
                            };
                            self.list.push(image);
                        }
                    }
                    Err(unlucky) => failure = Some(unlucky),
                }
            }
            if let (true, Some(error)) = (self.list.is_empty(), failure) {
                return Err(error.into());
            }
            let stopped = ExpandError::Interrupted { order: self.job.request.order };
            observer(2 * self.list.len()).then_some(()).ok_or(stopped)?;
        }
        Ok(())
    }
}
