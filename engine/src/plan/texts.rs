//! Many texts in one: the ids of a plan, and of the reports and logs that outlive it.

/// Texts by number, without an allocation for each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Texts {
    all: String,
    /// Where each ends.
    ends: Vec<u32>,
}

impl Texts {
    pub fn get(&self, n: usize) -> Option<&str> {
        let from = if n == 0 { 0 } else { *self.ends.get(n - 1)? };
        self.all.get(from as usize..*self.ends.get(n)? as usize)
    }

    fn bytes(&self, n: usize) -> &[u8] {
        let from = if n == 0 { 0 } else { self.ends[n - 1] };
        &self.all.as_bytes()[from as usize..self.ends[n] as usize]
    }

    pub fn len(&self) -> usize {
        self.ends.len()
    }

    pub fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.len()).map(|n| &self[n])
    }

    /// The number of a text, if they are sorted. O(log n).
    pub fn find(&self, text: &str) -> Option<usize> {
        let (mut from, mut to) = (0, self.len());
        let text = text.as_bytes();
        let head = head(text);
        while from < to {
            let middle = from + (to - from) / 2;
            let other = self.bytes(middle);
            match self::head(other).cmp(&head).then_with(|| other.cmp(text)) {
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Less => from = middle + 1,
                std::cmp::Ordering::Greater => to = middle,
            }
        }
        None
    }
}

/// The first bytes as a number: where two differ, so do the texts, in the same order.
#[inline]
fn head(text: &[u8]) -> u64 {
    match text.first_chunk() {
        Some(first) => u64::from_be_bytes(*first),
        None => text.iter().fold(0, |n, b| n << 8 | u64::from(*b)) << (8 * (8 - text.len()) as u32 % 64),
    }
}

impl<T: AsRef<str>> FromIterator<T> for Texts {
    fn from_iter<I: IntoIterator<Item = T>>(texts: I) -> Self {
        let mut made = Self::default();
        for text in texts {
            made.all.push_str(text.as_ref());
            made.ends.push(u32::try_from(made.all.len()).unwrap_or(u32::MAX));
        }
        made.all.shrink_to_fit();
        made.ends.shrink_to_fit();
        made
    }
}

/// The text of that number; empty if there is none.
impl std::ops::Index<usize> for Texts {
    type Output = str;

    fn index(&self, n: usize) -> &str {
        self.get(n).unwrap_or("")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_found_by_number_and_by_name() {
        let texts: Texts = ["", "a", "ab", "ä"].into_iter().collect();
        assert_eq!(texts.iter().collect::<Vec<_>>(), ["", "a", "ab", "ä"]);
        assert!((0..4).all(|n| texts.find(&texts[n]) == Some(n)));
        assert_eq!((texts.find("b"), texts.get(4), &texts[9], Texts::default().find("")), (None, None, "", None));
    }
}
