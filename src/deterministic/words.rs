//! Kernel classes in words.

use super::class::{Diagonal, KernelClass};
use std::fmt;

impl fmt::Display for Diagonal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Diagonal::Smooth => write!(f, "smooth"),
            Diagonal::Peaked { width } => write!(f, "peaked on the diagonal, half width {width:.1e} of the domain"),
            Diagonal::Kink => write!(f, "a kink on the diagonal"),
            Diagonal::Jump => write!(f, "a jump on the diagonal"),
            Diagonal::Logarithmic => write!(f, "logarithmic on the diagonal"),
            Diagonal::Algebraic { exponent } if *exponent > 0.0 => write!(f, "|x − y|^−{exponent:.2} on the diagonal"),
            Diagonal::Algebraic { exponent } => write!(f, "|x − y|^{:.2} on the diagonal", -exponent),
            Diagonal::NotIntegrable { exponent } => write!(f, "|x − y|^−{exponent:.2} on the diagonal: not integrable"),
        }
    }
}

impl fmt::Display for KernelClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.diagonal)?;
        if self.toeplitz {
            write!(f, ", a function of x − y")?;
        }
        if self.symmetric && !self.toeplitz {
            write!(f, ", symmetric")?;
        }
        if self.periodic {
            write!(f, ", periodic")?;
        }
        if let Some(rank) = self.rank {
            write!(f, ", rank {rank}")?;
        }
        match self.singular_ends {
            [true, true] => write!(f, ", singular in y at both ends")?,
            [true, false] => write!(f, ", singular in y at the lower end")?,
            [false, true] => write!(f, ", singular in y at the upper end")?,
            [false, false] => {}
        }
        if let Some(h) = self.half_wave {
            write!(f, ", oscillating with half waves of {h:.1e} of the domain")?;
        }
        Ok(())
    }
}
