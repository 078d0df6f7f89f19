//! Competing explanations of failed checks, ranked by what was measured.
//!
//! A [`View`] is what is known of a failing subject: the evidence of its cases
//! and a few more values. A [`Textbook`] is a published model that the subject's
//! sound functions agree with. Each [`Explanation`] makes claims that predict
//! numbers; a claim that they contradict is dropped, and the [`contest`] ranks
//! the rest by likelihood with a price for what had to be fitted.

mod by_counts;
mod compensation;
mod contest;
mod counted;
mod counts;
mod deviation;
mod discrete;
mod explanation;
mod fitting;
mod functions;
mod inputs;
mod lobes;
mod mistakes;
mod numbers;
mod parts;
mod pdf;
mod profile;
mod regression;
mod sampler;
mod shares;
mod side_by_side;
mod subjects;
mod support;
mod textbook;
mod value;
mod view;
mod weight;

pub use contest::{MARGIN, Verdict, diagnose};
pub use counts::{CountTest, Counts};
pub use explanation::{Claim, Explanation};
pub use parts::{At, Parts};
pub use profile::{Bin, Profile};
pub use regression::{BASES, Constant, Fitted, Pooled, Regression};
pub use subjects::{Diagnosed, diagnose_all, diagnose_here};
pub use textbook::{Lobe, Textbook};
pub use view::{Point, Seen, View};
