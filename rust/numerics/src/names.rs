//! Values of arguments by their names, and fields by theirs.

/// The rule of an argument that takes one of these names.
pub fn one_of(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    match quoted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("be {} or {last}", others.join(", ")),
        _ => format!("be {}", quoted.concat()),
    }
}

/// The names of an enumeration's values: `named_values! { Keep as "keep": "speed" => Speed, ... }`, with the argument that
/// takes them. Gives `ALL`, `name`, and [`str::parse`] with an error that lists the names.
#[macro_export]
macro_rules! named_values {
    ($kind:ident as $argument:literal: $($name:literal => $value:ident),+) => {
        impl $kind {
            /// Every value.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$value),+];

            /// The name by which [`str::parse`] finds it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name),+
                }
            }
        }

        impl std::str::FromStr for $kind {
            type Err = $crate::error::Error;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                let unknown = || {
                    $crate::error::Error::value($argument, $crate::names::one_of(&[$($name),+]), format!("{name:?}"))
                };
                match name {
                    $($name => Ok(Self::$value),)+
                    _ => Err(unknown()),
                }
            }
        }
    };
}

/// Fields with their names: `fields!(self: speed, slip)` is `[("speed", self.speed), ("slip", self.slip)]`.
#[macro_export]
macro_rules! fields {
    ($of:ident: $($field:ident),+) => {
        [$((stringify!($field), $of.$field)),+]
    };
}

/// The fields of a type of numbers as an array: `NAMES`, and in their order `values` and its reverse, `of`.
#[macro_export]
macro_rules! array_of_fields {
    ($kind:ident: $($field:ident),+) => {
        impl $kind {
            /// Names of the fields.
            pub const NAMES: [&'static str; [$(stringify!($field)),+].len()] = [$(stringify!($field)),+];

            /// The fields, in the order of [`Self::NAMES`].
            pub fn values(&self) -> [f64; Self::NAMES.len()] {
                [$(self.$field),+]
            }

            /// The reverse of [`Self::values`].
            pub fn of([$($field),+]: [f64; Self::NAMES.len()]) -> Self {
                Self { $($field),+ }
            }
        }
    };
}

/// Methods that return a field of the same name: `getters! { Rover: steered: &[usize]; size: f64; }`.
#[macro_export]
macro_rules! getters {
    ($kind:ident:) => {};
    ($kind:ident: $(#[$doc:meta])* $field:ident: &$out:ty; $($rest:tt)*) => {
        impl $kind {
            $(#[$doc])*
            #[inline]
            pub fn $field(&self) -> &$out {
                &self.$field
            }
        }
        $crate::getters! { $kind: $($rest)* }
    };
    ($kind:ident: $(#[$doc:meta])* $field:ident: $out:ty; $($rest:tt)*) => {
        impl $kind {
            $(#[$doc])*
            #[inline]
            pub fn $field(&self) -> $out {
                self.$field
            }
        }
        $crate::getters! { $kind: $($rest)* }
    };
}
