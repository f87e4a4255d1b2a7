//! The attribute that inlines every function of a block.
//!
//! Code on registers has the instructions of its level only inside the function that was entered with them, so all of it
//! has to be part of that function: a call from there would pass registers through memory.

use proc_macro::TokenStream;
use quote::ToTokens;
use syn::{ImplItem, ItemImpl, parse_macro_input, parse_quote};

/// `#[inline(always)]` on every function of an `impl` block.
#[proc_macro_attribute]
pub fn inline_always(_: TokenStream, block: TokenStream) -> TokenStream {
    let mut block = parse_macro_input!(block as ItemImpl);
    for item in &mut block.items {
        if let ImplItem::Fn(function) = item {
            function.attrs.push(parse_quote!(#[inline(always)]));
        }
    }
    block.into_token_stream().into()
}
