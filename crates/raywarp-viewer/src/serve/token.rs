//! The secret in the address.

use subtle::ConstantTimeEq;

use super::ServeError;

/// A secret that clients must know.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// 128 bits from the system, as hexadecimal digits.
    ///
    /// # Errors
    /// [`ServeError::Random`] where the system has none.
    pub fn random() -> Result<Self, ServeError> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(ServeError::Random)?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// A chosen one: 8 to 128 letters, digits, `-` or `_`, so that it stands in an address as it is.
    ///
    /// # Errors
    /// [`ServeError::Token`] for any other.
    pub fn chosen(text: &str) -> Result<Self, ServeError> {
        let plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if !(8..=128).contains(&text.len()) {
            return Err(ServeError::Token(format!("{} characters", text.len())));
        }
        match text.chars().find(|&character| !character.is_ascii() || !plain(character as u8)) {
            Some(character) => Err(ServeError::Token(format!("a {character:?}"))),
            None => Ok(Self(text.to_owned())),
        }
    }

    /// Whether a client knows it, in a time that does not depend on where texts of one length differ.
    pub fn is(&self, text: &str) -> bool {
        self.0.as_bytes().ct_eq(text.as_bytes()).into()
    }

    pub(super) fn text(&self) -> &str {
        &self.0
    }
}

/// Without the secret, so that no log has it.
impl std::fmt::Debug for Token {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Token")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_tokens_are_128_bits_and_differ() {
        let (a, b) = (Token::random().unwrap(), Token::random().unwrap());
        assert_eq!((a.0.len(), a.is(&b.0), a.is(&a.0)), (32, false, true));
        assert!(!format!("{a:?}").contains(&a.0));
        assert!(Token::chosen(&a.0).is_ok());
    }

    #[test]
    fn what_does_not_fit_an_address_is_refused() {
        for text in ["", "short", "with space", "with/slash", "wïth-umlaut", &"x".repeat(129)] {
            assert!(Token::chosen(text).is_err(), "{text}");
        }
        let token = Token::chosen("open-Sesame_1").unwrap();
        assert!(token.is("open-Sesame_1") && !token.is("open-Sesame_2") && !token.is("") && !token.is("open"));
    }
}
