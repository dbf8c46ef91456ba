//! Sections, functions and code marks of an ELF file.

use std::collections::BTreeMap;
use std::ops::Range;

use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

/// Contiguous bytes of the program.
pub struct Section {
    /// Address of the first byte.
    pub address: u32,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A function: its names (identical bodies may be merged) and its end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Function {
    /// Mangled names.
    pub names: Vec<String>,
    /// Address after the last byte.
    pub end: u32,
}

/// The program of a chip.
#[derive(Default)]
pub struct Image {
    /// Code and constants.
    pub sections: Vec<Section>,
    /// Addresses of the static data: `.data`, `.bss` and `.uninit`, in no order.
    pub data: Vec<Range<u32>>,
    /// By the address of the first instruction.
    pub functions: BTreeMap<u32, Function>,
    /// Whether code (true) or data (false) begins at an address: the mapping symbols `$t` and `$d` of the ABI.
    pub marks: BTreeMap<u32, bool>,
}

impl Image {
    /// Reads an ELF file for a little-endian 32-bit ARM.
    ///
    /// # Panics
    /// Where the file is not one: it comes from the linker.
    #[must_use]
    pub fn read(file: &[u8]) -> Self {
        let elf = ElfFile32::<Endianness>::parse(file).expect("cargo links an ELF file");
        let mut image = Self::default();
        let mut code_ends = Vec::new();
        for section in elf.sections() {
            let address = u32::try_from(section.address()).expect("32 bit");
            let end = address + u32::try_from(section.size()).expect("32 bit");
            match section.kind() {
                SectionKind::Text => code_ends.push(end),
                SectionKind::Data | SectionKind::UninitializedData => image.data.push(address..end),
                _ => {}
            }
            // Constants that the linker may merge are of the kind of strings.
            let kinds = [SectionKind::Text, SectionKind::ReadOnlyData, SectionKind::ReadOnlyString];
            if kinds.contains(&section.kind()) {
                let bytes = section.data().expect("the file has the bytes").to_vec();
                image.sections.push(Section { address, bytes });
            }
        }
        for symbol in elf.symbols() {
            let name = symbol.name().expect("UTF-8");
            let address = u32::try_from(symbol.address()).expect("32 bit");
            match name {
                "$t" => _ = image.marks.insert(address, true),
                "$d" => _ = image.marks.insert(address, false),
                _ if symbol.kind() == SymbolKind::Text && symbol.is_definition() => {
                    // The lowest bit marks Thumb code.
                    let function = image.functions.entry(address & !1).or_default();
                    function.names.push(name.to_owned());
                    let size = u32::try_from(symbol.size()).expect("32 bit");
                    function.end = function.end.max((address & !1) + size);
                }
                _ => {}
            }
        }
        image.set_missing_ends(&code_ends);
        image
    }

    /// Assembly gives no sizes: such a function ends at the next one, or with its section.
    fn set_missing_ends(&mut self, code_ends: &[u32]) {
        let starts: Vec<u32> = self.functions.keys().copied().collect();
        for (&start, function) in &mut self.functions {
            if function.end <= start {
                let next = starts.iter().chain(code_ends).copied().filter(|&end| end > start).min();
                function.end = next.expect("code is in a section");
            }
        }
    }

    /// The 16 bits at an address; `None` outside the sections.
    #[must_use]
    pub fn half(&self, address: u32) -> Option<u16> {
        self.sections.iter().find_map(|section| {
            let at = usize::try_from(address.checked_sub(section.address)?).ok()?;
            Some(u16::from_le_bytes([*section.bytes.get(at)?, *section.bytes.get(at + 1)?]))
        })
    }

    /// The 32 bits at an address.
    #[must_use]
    pub fn word(&self, address: u32) -> Option<u32> {
        Some(u32::from(self.half(address)?) | u32::from(self.half(address + 2)?) << 16)
    }

    /// Whether there is code at an address.
    #[must_use]
    pub fn is_code(&self, address: u32) -> bool {
        self.marks.range(..=address).next_back().is_some_and(|(_, &code)| code)
    }

    /// The function that contains an address, and its start.
    #[must_use]
    pub fn function_at(&self, address: u32) -> Option<(u32, &Function)> {
        let (&start, function) = self.functions.range(..=address).next_back()?;
        (address < function.end).then_some((start, function))
    }

    /// Starts of the functions that have a name with a property.
    pub fn named(&self, condition: impl Fn(&str) -> bool) -> Vec<u32> {
        let with = |(&start, function): (&u32, &Function)| {
            function.names.iter().any(|name| condition(name)).then_some(start)
        };
        self.functions.iter().filter_map(with).collect()
    }
}
