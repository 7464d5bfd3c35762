//! Items in one line for people: texts as they are, everything else as its type says it.

use tenon_engine::{Column, Text, Tree};

/// Item `i`, at most so many letters of it. Breaks of lines show as ↵.
#[must_use]
pub fn words(column: &Column, i: usize, most: usize) -> String {
    let line = |c: char| if matches!(c, '\n' | '\r') { '↵' } else { c };
    match column.get::<Text>(i) {
        Some(text) => {
            // Of \r\n one of both is shown. Only as much is read as is shown.
            let after = text.0.chars().skip(1).map(Some).chain([None]);
            let letters = text.0.chars().zip(after).filter(|(c, next)| (*c, *next) != ('\r', Some('\n')));
            cut(letters.map(|(c, _)| line(c)), most)
        }
        None if column.is_valid(i) => cut(column.summary(i).chars(), most),
        None => "(nothing)".to_owned(),
    }
}

/// A value: of one item the item itself, else how many of what there are.
#[must_use]
pub fn in_short(tree: &Tree, most: usize) -> String {
    match tree.branches() {
        [(_, one)] if one.get::<Text>(0).is_some() && one.len() == 1 => format!("text: {}", words(one, 0, most)),
        _ => cut(tree.summary().chars(), most),
    }
}

/// So many letters at most; the last one says that there were more.
fn cut(mut letters: impl Iterator<Item = char>, most: usize) -> String {
    let mut text: String = letters.by_ref().take(most).collect();
    if letters.next().is_some() {
        text.pop();
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_shown_as_they_are_and_cut_only_where_there_is_no_room() {
        let long = "a".repeat(300);
        let column = Column::new(vec![Text::from("oak"), Text::from("1\r\n2\n3"), Text::from(long.as_str())]);
        assert_eq!((words(&column, 0, 3).as_str(), words(&column, 1, 99).as_str()), ("oak", "1↵2↵3"));
        assert_eq!(words(&column, 2, 300), long);
        assert_eq!(words(&column, 2, 5), "aaaa…");
        assert_eq!(words(&Column::with_gaps(vec![None, Some(1.5)]), 0, 99), "(nothing)");
        assert_eq!(words(&Column::new(vec![1.5, 2.0]), 1, 99), "2.0");
        assert_eq!(in_short(&Tree::item(Text::from("oak")), 99), "text: oak");
        assert_eq!(in_short(&Tree::list(vec![1.0, 2.0]), 99), "2 × number");
    }
}
