//! Cells of tables that spreadsheets read.

/// What makes a spreadsheet take a cell for a formula, in ASCII and as wide characters,
/// or what it skips before it looks.
const FORMULA: [char; 11] = ['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠'];

/// A cell that no spreadsheet computes: one that would begin a formula begins with an
/// apostrophe. Numbers are left as they are.
pub fn guarded(cell: String) -> String {
    match cell.trim_start_matches(' ').starts_with(FORMULA) && !is_number(&cell) {
        true => format!("'{cell}"),
        false => cell,
    }
}

/// A sign, digits and a point: nothing that a spreadsheet would compute.
fn is_number(cell: &str) -> bool {
    let digits = cell.strip_prefix('-').unwrap_or(cell);
    digits.chars().all(|c| c.is_ascii_digit() || c == '.')
        && digits.starts_with(|c: char| c.is_ascii_digit())
        && digits.matches('.').count() <= 1
}

/// Rows as a CSV file; each cell is guarded.
pub fn csv(rows: impl IntoIterator<Item = Vec<String>>) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    for row in rows {
        writer.write_record(row.into_iter().map(guarded)).expect("memory takes every row");
    }
    writer.into_inner().expect("memory takes every row")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_is_a_formula() {
        for cell in [
            "=1+1",
            "+1",
            "-x",
            "@SUM(A1)",
            "\t=1",
            "\r=1",
            "\n=1",
            " =1",
            "＝1",
            "-1+cmd|' /C calc'!A0",
            "--1",
        ] {
            assert_eq!(guarded(cell.into()), format!("'{cell}"));
        }
        for cell in ["-1", "-1.5", "0", "12", "a=b", "", "1-2", "'=1"] {
            assert_eq!(guarded(cell.into()), cell);
        }
    }

    #[test]
    fn cells_come_back_as_they_were() {
        let rows =
            [vec!["a,b".to_string(), "x\"y".into(), "two\nlines".into()], vec!["=1".into(), String::new()]];
        let bytes = csv(rows);
        let mut reader =
            csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes.as_slice());
        let read: Vec<Vec<String>> =
            reader.records().map(|r| r.unwrap().iter().map(Into::into).collect()).collect();
        assert_eq!(read, [vec!["a,b", "x\"y", "two\nlines"], vec!["'=1", ""]]);
    }
}
