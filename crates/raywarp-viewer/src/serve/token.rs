//! The secret that clients must know.

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

    /// A chosen one: 8 to 128 characters, none of them a control character, no space at either end.
    ///
    /// # Errors
    /// [`ServeError::Token`] for any other. The error does not hold the text.
    pub fn chosen(text: &str) -> Result<Self, ServeError> {
        let length = text.chars().count();
        if !(8..=128).contains(&length) {
            return Err(ServeError::Token(format!("{length} characters")));
        }
        if text.chars().any(char::is_control) {
            return Err(ServeError::Token("a control character, perhaps the end of a line".to_owned()));
        }
        if text.trim() != text {
            return Err(ServeError::Token("a space at one end".to_owned()));
        }
        Ok(Self(text.to_owned()))
    }

    /// Whether a client knows it, in a time that does not depend on where texts of one length differ.
    pub fn is(&self, text: &str) -> bool {
        self.0.as_bytes().ct_eq(text.as_bytes()).into()
    }

    /// For those who may know it.
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
    fn what_nobody_could_type_again_is_refused() {
        let error = |text: &str| Token::chosen(text).unwrap_err().to_string();
        assert!(error("").contains("0 characters") && error("short").contains("5 characters"));
        assert!(error(&"x".repeat(129)).contains("129 characters"));
        for (text, why) in [("two\nlines", "control"), ("a secret\n", "control"), ("a secret ", "space at one end")] {
            assert!(error(text).contains(why) && !error(text).contains("secret "), "{text}");
        }
        let token = Token::chosen("open-Sesame_1").unwrap();
        assert!(token.is("open-Sesame_1") && !token.is("open-Sesame_2") && !token.is("") && !token.is("open"));
    }
}
