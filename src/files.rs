//! stub
/// stub
pub fn parse_value(t: &str) -> crate::species::parameter::Value { crate::species::parameter::Value::Choice(t.into()) }
