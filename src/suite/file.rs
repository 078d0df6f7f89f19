//! The format of suite files.

use super::mistake::{Mistake, SuiteError};
use super::plan::{Settings, Source, Waiver};
use super::promises::{claims, waivers};
use super::reader::{Node, Reader, azimuth, entries, fraction, polar, positive};
use crate::bsdf::{ClaimsPatch, Transport};
use crate::checks;
use crate::plugins::{Named, in_path};
use crate::registry::{MEASURED, Value, nearest};
use std::path::Path;
use std::time::Duration;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Which combinations of values become cases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cover {
    /// All of them.
    #[default]
    All,
    /// So many that every two values of two factors meet at least once.
    Pairs,
}

/// A suite as it is written, before its names are looked up.
#[derive(Clone, Debug)]
pub struct SuiteFile {
    /// Its name.
    pub name: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Probability that a run of correct subjects shows any failure.
    pub false_alarm: f64,
    /// Sharpness.
    pub settings: Settings,
    /// Polar angles of wo in degrees.
    pub theta: Vec<f64>,
    /// Azimuths of wo in degrees.
    pub phi: Vec<f64>,
    /// Which combinations become cases.
    pub cover: Cover,
    /// Whether the other side of a subject that has one is measured too.
    pub sides: bool,
    /// The one mode of transport to measure, in place of those that subjects claim.
    pub transport: Option<Transport>,
    /// Checks to run; all where empty.
    pub checks: Vec<String>,
    /// What is measured.
    pub entries: Vec<Entry>,
    /// What the text is called in messages: a path.
    pub source_name: String,
    /// The text that the spans refer to.
    pub text: String,
}

/// One `[[subject]]`.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The registered model.
    pub model: Spanned<String>,
    /// The name of its row in reports.
    pub label: Option<String>,
    /// Parameters with one value or several.
    pub parameters: Vec<(Spanned<String>, Vec<Spanned<Value>>)>,
    /// Claims in place of the subject's.
    pub claims: ClaimsPatch,
    /// Accepted failures.
    pub waivers: Vec<Waiver>,
    /// Another subject to compare with.
    pub reference: Option<Spanned<String>>,
    /// In place of the suite's.
    pub theta: Option<Vec<f64>>,
    /// In place of the suite's.
    pub phi: Option<Vec<f64>>,
    /// In place of the suite's.
    pub cover: Option<Cover>,
    /// In place of the suite's.
    pub samples: Option<u64>,
}

/// What the command line puts in place of what a suite says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// The seed.
    pub seed: Option<u64>,
    /// The cap of samples.
    pub samples: Option<u64>,
    /// Polar angles in degrees; the suite's where empty.
    pub theta: Vec<f64>,
    /// Azimuths in degrees; the suite's where empty.
    pub phi: Vec<f64>,
    /// Checks; the suite's where empty.
    pub checks: Vec<String>,
    /// What one call of a plugin may take.
    pub call_limit: Option<Duration>,
    /// Bytes that a plugin may take.
    pub memory: Option<u64>,
    /// Whether libraries are loaded into gonio itself.
    pub in_process: bool,
}

/// Polar angles where none are given: normal, generic, and towards grazing,
/// where missing terms show with few samples.
pub const THETA: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];

/// Azimuths where none are given: generic ones, since a frame built in the wrong
/// basis is invisible at 0.
pub const PHI: [f64; 3] = [17.0, 137.0, 257.0];

/// Seed where none is given.
pub const SEED: u64 = 1;

/// Probability of any false alarm where none is given.
pub const FALSE_ALARM: f64 = 1e-6;

const SUITE_KEYS: [&str; 13] = [
    "name",
    "seed",
    "false_alarm",
    "tolerance",
    "samples",
    "detect",
    "theta",
    "phi",
    "cover",
    "time_limit",
    "call_limit",
    "memory",
    "checks",
];

/// Keys of a `[[subject]]` that are not parameters of its model.
pub(super) const SUBJECT_KEYS: [&str; 12] = [
    "use",
    "process",
    "library",
    "wasm",
    "claims",
    "waive",
    "reference",
    "theta",
    "phi",
    "cover",
    "samples",
    "label",
];

/// Keys of a `[[subject]]` that say what is measured.
const ROUTES: [&str; 4] = ["use", "process", "library", "wasm"];

impl SuiteFile {
    /// A suite without subjects, all at its defaults.
    pub fn new(name: &str, source_name: &str, text: &str) -> Self {
        Self {
            name: name.into(),
            seed: SEED,
            false_alarm: FALSE_ALARM,
            settings: Settings::default(),
            theta: THETA.to_vec(),
            phi: PHI.to_vec(),
            cover: Cover::All,
            sides: true,
            transport: None,
            checks: Vec::new(),
            entries: Vec::new(),
            source_name: source_name.into(),
            text: text.into(),
        }
    }

    /// Reads a suite. It is called by the stem of `source_name` unless it names itself.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, SuiteError> {
        let (file, mistakes) = Self::read(source_name, text)?;
        if mistakes.is_empty() { Ok(file) } else { Err(file.error(mistakes)) }
    }

    /// As [`parse`](Self::parse), with the mistakes that leave something to go on with.
    pub(super) fn read(source_name: &str, text: &str) -> Result<(Self, Vec<Mistake>), SuiteError> {
        let path = std::path::Path::new(source_name);
        let stem = path.file_stem().map_or(source_name.into(), |s| s.to_string_lossy());
        let mut file = Self::new(&stem, source_name, text);
        let table = DeTable::parse(text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            file.error(vec![Mistake::new(span, format!("this is not TOML: {}", e.message()), "here")])
        })?;
        let mut reader = Reader::default();
        for (key, span, value) in entries(table.get_ref()) {
            match (key, value.get_ref()) {
                ("suite", DeValue::Table(table)) => file.read_suite(&mut reader, table),
                ("subject", DeValue::Array(list)) => {
                    for item in list.iter() {
                        file.read_subject(&mut reader, item);
                    }
                }
                ("suite" | "subject", _) => {
                    let wanted = if key == "suite" { "a table: [suite]" } else { "tables: [[subject]]" };
                    reader.refuse(key, value, wanted);
                }
                _ => reader.unknown(span, "table of a suite", key, &["suite", "subject"]),
            }
        }
        Ok((file, reader.mistakes))
    }

    /// Puts what the command line asks for in place of what is written. Polar
    /// angles that are given so are meant as they are: no other side is added.
    pub fn apply(&mut self, overrides: &Overrides) {
        set(&mut self.seed, overrides.seed);
        set(&mut self.settings.samples, overrides.samples);
        let limits = &mut self.settings.limits;
        set(&mut limits.call, overrides.call_limit);
        set(&mut limits.memory, overrides.memory);
        limits.in_process |= overrides.in_process;
        if !overrides.theta.is_empty() {
            self.theta.clone_from(&overrides.theta);
            self.sides = false;
        }
        if !overrides.phi.is_empty() {
            self.phi.clone_from(&overrides.phi);
        }
        if !overrides.checks.is_empty() {
            self.checks.clone_from(&overrides.checks);
        }
        for entry in &mut self.entries {
            entry.theta.take_if(|_| !overrides.theta.is_empty());
            entry.phi.take_if(|_| !overrides.phi.is_empty());
            entry.samples.take_if(|_| overrides.samples.is_some());
        }
    }

    /// The line of an entry, where the suite is a file.
    pub(super) fn source_of(&self, entry: &Entry) -> Option<Source> {
        let file = Path::new(&self.source_name).is_file().then(|| self.source_name.clone())?;
        let before = self.text.get(..entry.model.span().start)?;
        Some(Source { file, line: 1 + before.matches('\n').count() })
    }

    /// These mistakes of this suite.
    pub(super) fn error(&self, mistakes: Vec<Mistake>) -> SuiteError {
        SuiteError::new(&self.source_name, &self.text, mistakes)
    }

    fn read_suite(&mut self, reader: &mut Reader, table: &DeTable) {
        for (key, span, value) in entries(table) {
            match key {
                "name" => set(&mut self.name, reader.text(key, value).map(Spanned::into_inner)),
                "seed" => set(&mut self.seed, reader.seed(key, value)),
                "false_alarm" => set(&mut self.false_alarm, reader.number(key, value, fraction)),
                "tolerance" => self.settings.tolerance = reader.number(key, value, fraction),
                "samples" => set(&mut self.settings.samples, reader.count(key, value)),
                "detect" => set(&mut self.settings.detect, reader.number(key, value, positive)),
                "theta" => set(&mut self.theta, reader.numbers(key, value, polar)),
                "phi" => set(&mut self.phi, reader.numbers(key, value, azimuth)),
                "cover" => set(&mut self.cover, cover(reader, value)),
                "time_limit" => {
                    let limit = reader.number(key, value, time_limit);
                    set(&mut self.settings.time_limit, limit.map(Duration::from_secs_f64));
                }
                "call_limit" => {
                    let limit = reader.number(key, value, time_limit);
                    set(&mut self.settings.limits.call, limit.map(Duration::from_secs_f64));
                }
                "memory" => {
                    let memory = reader.number(key, value, mebibytes);
                    set(&mut self.settings.limits.memory, memory.map(|mib| (mib as u64) << 20));
                }
                "checks" => {
                    for item in reader.items(key, value).unwrap_or_default() {
                        if let Some(id) = check_id(reader, key, item) {
                            if self.checks.contains(&id) {
                                reader.twice(key, item.span(), &format!("`{id}`"));
                            } else {
                                self.checks.push(id);
                            }
                        }
                    }
                }
                _ => reader.unknown(span, "key of [suite]", key, &SUITE_KEYS),
            }
        }
    }

    fn read_subject(&mut self, reader: &mut Reader, item: &Node) {
        let DeValue::Table(table) = item.get_ref() else {
            reader.refuse("subject", item, "tables: [[subject]]");
            return;
        };
        let ways: Vec<_> = entries(table).into_iter().filter(|(key, ..)| ROUTES.contains(key)).collect();
        if let [(first, ..), (second, span, _), ..] = &ways[..] {
            let message = format!("a [[subject]] has `{first}` and `{second}`");
            let help = "one of them says what is measured: leave the other out";
            reader.note(Mistake::new(span.clone(), message, "the second").help(help));
            return;
        }
        let mut model = None;
        let mut named = false;
        let mut entry = Entry {
            model: Spanned::new(item.span(), String::new()),
            label: None,
            parameters: Vec::new(),
            claims: ClaimsPatch::default(),
            waivers: Vec::new(),
            reference: None,
            theta: None,
            phi: None,
            cover: None,
            samples: None,
        };
        for (key, span, value) in entries(table) {
            match key {
                "use" => (named, model) = (true, reader.text(key, value)),
                "file" => {
                    if !ROUTES.iter().any(|key| table.contains_key(*key)) {
                        (named, model) = (true, Some(Spanned::new(value.span(), MEASURED.into())));
                    }
                    let files = self.read_files(reader, value);
                    entry.parameters.push((Spanned::new(span, key.into()), files));
                }
                "label" => entry.label = self.read_label(reader, value),
                "claims" => entry.claims = claims(reader, value),
                "waive" => entry.waivers = waivers(reader, value, today()),
                "reference" => {
                    let text = reader.text(key, value);
                    entry.reference = text.map(|t| Spanned::new(t.span(), self.subject_beside(t.get_ref())));
                }
                "theta" => entry.theta = reader.numbers(key, value, polar),
                "phi" => entry.phi = reader.numbers(key, value, azimuth),
                "cover" => entry.cover = cover(reader, value),
                "samples" => entry.samples = reader.count(key, value),
                "process" => (named, model) = (true, self.read_command(reader, value)),
                "library" | "wasm" => (named, model) = (true, self.read_plugin(reader, key, value)),
                "shader" if !table.contains_key("use") => {
                    named = true;
                    let message = "subjects from a `shader` are not supported by this version";
                    let help = "use = \"NAME\" takes a registered subject; `gonio list` shows them";
                    reader.note(Mistake::new(span, message, "not supported").help(help));
                }
                _ if !is_parameter(value) && nearest(key, SUBJECT_KEYS.into_iter()).is_some() => {
                    reader.unknown(span, "key of a [[subject]]", key, &SUBJECT_KEYS);
                }
                _ => {
                    let values = parameter(reader, key, value);
                    entry.parameters.push((Spanned::new(span, key.into()), values));
                }
            }
        }
        if !named {
            let help = "add use = \"NAME\" (`gonio list` shows the names), file = \"PATH\", process = [\"COMMAND\", …], \
                library = \"PATH.so\" or wasm = \"PATH.wasm\"";
            // The span of an entry is its header.
            reader.note(Mistake::new(item.span(), "a [[subject]] without `use`", "what is it?").help(help));
        }
        // Files that are not there were told already.
        let lacks_file =
            |(name, values): &(Spanned<String>, Vec<_>)| name.get_ref() == "file" && values.is_empty();
        if let Some(model) = model.filter(|_| !entry.parameters.iter().any(lacks_file)) {
            self.entries.push(Entry { model, ..entry });
        }
    }

    /// The paths of files, which are relative to the suite's own folder.
    fn read_files(&self, reader: &mut Reader, value: &Node) -> Vec<Spanned<Value>> {
        let folder = Path::new(&self.source_name).parent().unwrap_or(Path::new(""));
        let mut files: Vec<Spanned<Value>> = Vec::new();
        for item in reader.items("file", value).unwrap_or_default() {
            let Some(text) = reader.text("file", item) else { continue };
            let path = folder.join(text.get_ref());
            let shown = path.display().to_string();
            if !path.is_file() {
                let what = if path.exists() { "is not a file" } else { "does not exist" };
                let message = format!("`{shown}` {what}");
                let help = "paths are relative to the folder of the suite";
                reader.note(Mistake::new(text.span(), message, "no such file").help(help));
                continue;
            }
            let file = Spanned::new(text.span(), Value::Text(shown.clone()));
            if files.contains(&file) {
                reader.twice("file", text.span(), &shown);
            } else {
                files.push(file);
            }
        }
        files
    }

    /// The path of a plugin, FILE or FILE#MODEL, relative to the suite's own folder.
    fn read_plugin(&self, reader: &mut Reader, key: &str, value: &Node) -> Option<Spanned<String>> {
        let text = reader.text(key, value)?;
        let path = self.beside(text.get_ref());
        let word = text.get_ref();
        let model = word.rsplit_once('#').map_or(0, |(file, _)| word.len() - file.len());
        let file = &path[..path.len() - model];
        let right = |named: &Option<Named>| match key {
            "library" => matches!(named, Some(Named::Library(_))),
            _ => matches!(named, Some(Named::Wasm(_))),
        };
        if !right(&Named::of(file)) {
            let (what, help) = match (Path::new(file).is_file(), key) {
                (false, _) => ("does not exist", "paths are relative to the folder of the suite"),
                (true, "library") => ("is no shared library", "its name should end with .so, .dylib or .dll"),
                (true, _) => ("is no WebAssembly module", "its name should end with .wasm"),
            };
            reader.note(Mistake::new(text.span(), format!("`{file}` {what}"), "this file").help(help));
            return None;
        }
        Some(Spanned::new(text.span(), path))
    }

    /// A command, as a list of words or as a shell would read it. A word that names a
    /// file beside the suite is the path of that file.
    fn read_command(&self, reader: &mut Reader, value: &Node) -> Option<Spanned<String>> {
        let mut words = Vec::new();
        for item in reader.items("process", value)? {
            let word = reader.text("process", item)?.into_inner();
            match value.get_ref() {
                DeValue::String(_) => match shell_words::split(&word) {
                    Ok(split) => words.extend(split),
                    Err(e) => {
                        reader.note(Mistake::new(item.span(), format!("`process`: {e}"), "here"));
                        return None;
                    }
                },
                _ => words.push(word),
            }
        }
        let program = words.first_mut()?;
        if !program.contains('/') {
            // A command is told from a model by its path, or by having arguments.
            match in_path(program) {
                Some(path) => *program = path.display().to_string(),
                None if Path::new(&self.beside(program)).is_file() => {
                    let path = Path::new(".").join(self.beside(program));
                    *program = path.display().to_string();
                }
                None => {
                    let message = format!("no program `{program}` is in PATH or beside the suite");
                    reader.note(Mistake::new(value.span(), message, "this command"));
                    return None;
                }
            }
        }
        let mut words: Vec<String> = words.iter().map(|word| self.beside(word)).collect();
        // The name of a model is no part of the command.
        let last = words.last_mut()?;
        let model = match last.rsplit_once('#') {
            Some((file, model)) if Path::new(file).is_file() => {
                let model = format!("#{model}");
                *last = last[..last.len() - model.len()].into();
                model
            }
            _ => String::new(),
        };
        // A path by itself is no command to be quoted.
        let command = match &words[..] {
            [path] if Path::new(path).is_file() => path.clone(),
            words => shell_words::join(words),
        };
        Some(Spanned::new(value.span(), command + &model))
    }

    /// A subject in a file beside the suite; others as they are written.
    fn subject_beside(&self, text: &str) -> String {
        match text.split_once(':') {
            Some((file, parameters)) => format!("{}:{parameters}", self.beside(file)),
            None => self.beside(text),
        }
    }

    /// The path of a file beside the suite; other words as they are.
    fn beside(&self, word: &str) -> String {
        let folder = Path::new(&self.source_name).parent().unwrap_or(Path::new(""));
        let path = folder.join(word);
        let file = word.split('#').next().unwrap_or(word);
        if folder.join(file).is_file() { path.display().to_string() } else { word.into() }
    }

    fn read_label(&self, reader: &mut Reader, value: &Node) -> Option<String> {
        let label = reader.text("label", value)?;
        if self.entries.iter().any(|e| e.label.as_ref() == Some(label.get_ref())) {
            let message = format!("another subject is labelled `{}`", label.get_ref());
            reader.note(
                Mistake::new(label.span(), message, "the second time")
                    .help("labels name rows: choose another"),
            );
        }
        Some(label.into_inner())
    }
}

/// The day by which waivers expire: that of Greenwich, the same on every machine.
fn today() -> jiff::civil::Date {
    jiff::Timestamp::now().to_zoned(jiff::tz::TimeZone::UTC).date()
}

/// Puts a value that was read in its place.
pub(crate) fn set<T>(place: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *place = value;
    }
}

/// Seconds that a case may take.
pub fn time_limit(seconds: f64) -> Result<f64, String> {
    // A year: more is a slip, and Duration has an end.
    if seconds > 0.0 && seconds <= 3.2e7 {
        Ok(seconds)
    } else {
        Err(format!("{seconds} is not a time; type seconds, for example 60"))
    }
}

/// Mebibytes that a plugin may take.
pub fn mebibytes(mib: f64) -> Result<f64, String> {
    // Less than 16 starts no program; more than 2^24 (16 TiB) is a slip.
    if (16.0..=16_777_216.0).contains(&mib) {
        Ok(mib)
    } else {
        Err(format!("{mib} MiB is no memory for a plugin; type for example 4096"))
    }
}

fn cover(reader: &mut Reader, value: &Node) -> Option<Cover> {
    Some(if reader.word("cover", value, &["all", "pairs"])? == "all" { Cover::All } else { Cover::Pairs })
}

pub(crate) fn check_id(reader: &mut Reader, key: &str, value: &Node) -> Option<String> {
    let text = reader.text(key, value)?;
    if checks::find(text.get_ref()).is_none() {
        let known: Vec<_> = checks::all().iter().map(|c| c.id()).collect();
        reader.unknown(text.span(), "check", text.get_ref(), &known);
        return None;
    }
    Some(text.into_inner())
}

/// Whether a parameter may have this value.
fn is_parameter(value: &Node) -> bool {
    let simple =
        |v: &Node| matches!(v.get_ref(), DeValue::String(_) | DeValue::Integer(_) | DeValue::Float(_));
    value.get_ref().as_array().map_or_else(|| simple(value), |list| list.iter().all(simple))
}

fn parameter(reader: &mut Reader, key: &str, value: &Node) -> Vec<Spanned<Value>> {
    let mut values: Vec<Spanned<Value>> = Vec::new();
    for item in reader.items(key, value).unwrap_or_default() {
        let Some(found) = reader.value(key, item) else { continue };
        if values.contains(&found) {
            reader.twice(key, item.span(), &found.get_ref().to_string());
        } else {
            values.push(found);
        }
    }
    values
}
