//! Values of arguments by their names.

/// The rule of an argument that takes one of these names.
pub fn one_of(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    match quoted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("be {} or {last}", others.join(", ")),
        _ => format!("be {}", quoted.concat()),
    }
}

/// The names of an enumeration's values: `named_values! { Keep as "keep": "speed" => Speed, ... }`, with the argument that
/// takes them. Gives `name`, and [`str::parse`] with an error that lists the names.
#[macro_export]
macro_rules! named_values {
    ($kind:ident as $argument:literal: $($name:literal => $value:ident),+) => {
        impl $kind {
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
