//! The addresses that are printed: each holds a ticket, which is exchanged once for the secret. What a browser keeps of
//! the addresses that were opened is worth nothing then.

use std::fmt;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::{Mutex, OnceLock};

use super::registry::lock;
use super::{address, ServeError, Token};

/// What to open in a browser.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Addresses {
    /// On this machine, or on one that reaches it.
    pub here: String,
    /// On a machine where [`Server::ssh_line`](super::Server::ssh_line) runs.
    pub through_ssh: String,
}

type Tell = Box<dyn Fn(&Addresses) + Send + Sync>;

/// Gives out tickets, one at a time.
pub struct Invitations {
    at: SocketAddr,
    /// None where no secret is needed, or the system has no more random numbers.
    ticket: Mutex<Option<Token>>,
    tell: OnceLock<Tell>,
}

impl Invitations {
    /// To a server at an address; with tickets where it has a secret.
    ///
    /// # Errors
    /// [`ServeError::Random`] where the system has no random numbers.
    pub fn new(at: SocketAddr, has_secret: bool) -> Result<Self, ServeError> {
        let ticket = has_secret.then(Token::random).transpose()?;
        Ok(Self { at, ticket: Mutex::new(ticket), tell: OnceLock::new() })
    }

    /// With the ticket that nobody has used.
    pub fn addresses(&self) -> Addresses {
        let ticket = lock(&self.ticket);
        let url = |at| address::url(at, ticket.as_ref());
        Addresses { here: url(self.at), through_ssh: url((Ipv4Addr::LOCALHOST, self.at.port()).into()) }
    }

    /// Who hears of the next addresses. The first to be named stays it.
    pub fn tell(&self, tell: Tell) {
        let _ = self.tell.set(tell);
    }

    /// Whether a ticket can be exchanged.
    pub fn is_valid(&self, ticket: &str) -> bool {
        lock(&self.ticket).as_ref().is_some_and(|valid| valid.is(ticket))
    }

    /// Exchanges a ticket, and makes the next; whether it was valid.
    pub fn redeem(&self, ticket: &str) -> bool {
        let mut valid = lock(&self.ticket);
        if !valid.as_ref().is_some_and(|valid| valid.is(ticket)) {
            return false;
        }
        *valid = Token::random().ok();
        drop(valid);
        if let Some(tell) = self.tell.get() {
            tell(&self.addresses());
        }
        true
    }
}

/// Without the ticket, so that no log has it.
impl fmt::Debug for Invitations {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Invitations to {}", self.at)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn ticket(addresses: &Addresses) -> String {
        addresses.here.split_once("/#ticket=").unwrap().1.to_owned()
    }

    #[test]
    fn a_ticket_is_exchanged_once_and_the_next_one_is_told() {
        let invitations = Invitations::new(([127, 0, 0, 1], 8787).into(), true).unwrap();
        let told = Arc::new(Mutex::new(Vec::new()));
        let hears = Arc::clone(&told);
        invitations.tell(Box::new(move |addresses| hears.lock().unwrap().push(addresses.clone())));
        let first = ticket(&invitations.addresses());
        assert!(!invitations.redeem("") && !invitations.redeem(&first[1..]) && invitations.is_valid(&first));
        assert!(invitations.redeem(&first) && !invitations.is_valid(&first) && !invitations.redeem(&first));
        assert_eq!(*told.lock().unwrap(), [invitations.addresses()]);
        assert!(ticket(&told.lock().unwrap()[0]) != first && !format!("{invitations:?}").contains(&first));
    }

    #[test]
    fn without_a_secret_there_are_no_tickets() {
        let invitations = Invitations::new(([127, 0, 0, 1], 8787).into(), false).unwrap();
        assert_eq!(invitations.addresses().here, "http://127.0.0.1:8787/");
        assert!(!invitations.is_valid("") && !invitations.redeem(""));
    }
}
