//! Decides whose requests the server answers.

use core::net::IpAddr;

use axum::http::HeaderMap;
use axum::http::header::{HOST, ORIGIN};

/// Whether a request names an address of this server and not a foreign name that points here.
pub(crate) fn host_allowed(headers: &HeaderMap) -> bool {
    let Some(host) = headers.get(HOST).and_then(|host| host.to_str().ok()) else {
        return false;
    };
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.split(':').next().unwrap_or_default(),
    };
    name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok()
}

/// Whether a page of this server, or no page at all, asks for a WebSocket.
pub(crate) fn origin_allowed(headers: &HeaderMap) -> bool {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    match (headers.contains_key(ORIGIN), text(ORIGIN), text(HOST)) {
        (false, _, _) => true,
        (true, Some(origin), Some(host)) => origin
            .split_once("://")
            .is_some_and(|(_, place)| place.eq_ignore_ascii_case(host)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    fn headers(host: &'static str, origin: Option<&'static str>) -> HeaderMap {
        let mut headers = HeaderMap::new();
        headers.insert(HOST, HeaderValue::from_static(host));
        if let Some(origin) = origin {
            headers.insert(ORIGIN, HeaderValue::from_static(origin));
        }
        headers
    }

    #[test]
    fn a_foreign_name_is_not_answered() {
        for host in [
            "127.0.0.1:8787",
            "localhost:8787",
            "LOCALHOST",
            "[::1]:8787",
        ] {
            assert!(host_allowed(&headers(host, None)), "{host}");
        }
        for host in [
            "evil.example:8787",
            "127.0.0.1.evil.example",
            "",
            "localhost.evil.example",
        ] {
            assert!(!host_allowed(&headers(host, None)), "{host}");
        }
        assert!(!host_allowed(&HeaderMap::new()));
    }

    #[test]
    fn a_page_of_another_site_gets_no_socket() {
        let own = headers("127.0.0.1:8787", Some("http://127.0.0.1:8787"));
        assert!(origin_allowed(&own));
        assert!(origin_allowed(&headers("127.0.0.1:8787", None)));
        for origin in ["http://evil.example", "null", "http://127.0.0.1:9999"] {
            assert!(
                !origin_allowed(&headers("127.0.0.1:8787", Some(origin))),
                "{origin}"
            );
        }
    }
}
