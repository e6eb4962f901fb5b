//! The attribute `#[constants]` of a built model, which makes it constants that firmware reads in place.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{ItemStruct, WherePredicate, parse_macro_input, parse_quote};

/// Gives a struct the same layout on every target, lets zerocopy read it in place, and implements `Constants`.
///
/// Every field is a number of fixed width, a `bool`, an array of these or such a struct.
#[proc_macro_attribute]
pub fn constants(
    _arguments: proc_macro::TokenStream,
    item: proc_macro::TokenStream,
) -> proc_macro::TokenStream {
    let item = parse_macro_input!(item as ItemStruct);
    let implementation = implementation(&item);
    quote! {
        #[derive(::zerocopy::Immutable, ::zerocopy::TryFromBytes)]
        #[repr(C)]
        #item
        #implementation
    }
    .into()
}

fn implementation(item: &ItemStruct) -> TokenStream {
    let fields: Vec<_> = item.fields.members().collect();
    let types: Vec<_> = item.fields.iter().map(|field| &field.ty).collect();
    let mut generics = item.generics.clone();
    let bound = |ty| -> WherePredicate { parse_quote!(#ty: crate::constants::Constants) };
    generics.make_where_clause().predicates.extend(types.iter().map(bound));
    let name = &item.ident;
    let (parameters, arguments, bounds) = generics.split_for_impl();
    quote! {
        #[allow(private_bounds)]
        impl #parameters crate::constants::Constants for #name #arguments #bounds {
            const FINGERPRINT: u32 = crate::constants::fingerprint_of_fields(&[
                #((stringify!(#fields), <#types as crate::constants::Constants>::FINGERPRINT),)*
            ]);

            fn write(&self, bytes: &mut [u8]) {
                #({
                    let start = ::core::mem::offset_of!(Self, #fields);
                    let end = start + ::core::mem::size_of::<#types>();
                    crate::constants::Constants::write(&self.#fields, &mut bytes[start..end]);
                })*
            }
        }
    }
}
