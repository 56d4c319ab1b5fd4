"""File systems of object stores, by the variables that the vendors' own tools take; what their faults mean."""

from __future__ import annotations

import base64
import configparser
import datetime
import os
import re
import threading
from collections.abc import Callable
from typing import Any

import pyarrow as pa

from convoy.errors import StoreError

ATTEMPTS = 5
"""How often a request to S3 is made before it has failed."""
SECONDS = 60
"""How long one to Google is repeated; pyarrow would take a quarter of an hour."""

_VARIABLES = {
    "s3": (
        "AWS_ACCESS_KEY_ID",
        "AWS_SECRET_ACCESS_KEY",
        "AWS_SESSION_TOKEN",
        "AWS_PROFILE",
        "AWS_SHARED_CREDENTIALS_FILE",
        "AWS_CONFIG_FILE",
        "AWS_SKIP_SIGNATURE",
        "AWS_REGION",
        "AWS_DEFAULT_REGION",
        "AWS_ENDPOINT_URL_S3",
        "AWS_ENDPOINT_URL",
        "AWS_ALLOW_HTTP",
    ),
    "gs": ("GOOGLE_APPLICATION_CREDENTIALS", "STORAGE_EMULATOR_HOST"),
    "az": (
        "AZURE_STORAGE_ACCOUNT_NAME",
        "AZURE_STORAGE_ACCOUNT_KEY",
        "AZURE_STORAGE_SAS_TOKEN",
        "AZURE_STORAGE_USE_EMULATOR",
    ),
}
_ACCESS = {
    "s3": "AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_SESSION_TOKEN or AWS_PROFILE",
    "gs": "GOOGLE_APPLICATION_CREDENTIALS",
    "az": "AZURE_STORAGE_ACCOUNT_NAME and AZURE_STORAGE_ACCOUNT_KEY or AZURE_STORAGE_SAS_TOKEN",
}
_REFUSED = re.compile(
    r"ACCESS_DENIED|INVALID_ACCESS_KEY_ID|INVALID_CLIENT_TOKEN_ID|SIGNATURE|EXPIRED|MISSING_AUTHENTICATION"
    r"|PERMISSION_DENIED|UNAUTHENTICATED|AuthenticationFailed|AuthorizationFailure|AuthorizationPermissionMismatch"
    r"|HTTP status 40[13]\b|credential|authenticate|authentication",
    re.IGNORECASE,
)
_ELSEWHERE = re.compile(r"HTTP status 30[1278]\b|PERMANENT_REDIRECT|AuthorizationHeaderMalformed")
_AWAY = re.compile(
    r"NETWORK_CONNECTION|REQUEST_TIMEOUT|SLOW_DOWN|SERVICE_UNAVAILABLE|INTERNAL_FAILURE|THROTTLING|UNAVAILABLE"
    r"|DEADLINE_EXCEEDED|HTTP status 5\d\d|curl|connect|resolve|timed? ?out",
    re.IGNORECASE,
)

_CODE = re.compile(
    r"(curlCode: \d+, [^;]*)|AWS Error ((?!NETWORK)[A-Z_]+(?: \(HTTP status \d+\))?)|(HTTP status \d+)"
    r"|google::cloud::Status\(([A-Z_]+)|Azure Error: \[?(\w+)"
)


class _Talks:
    """Threads that talk to a service. A fork waits for them: a child would inherit locks of Amazon's library
    that they hold, with nobody to give them back, and wait for ever when it makes a connection of its own."""

    def __init__(self) -> None:
        self._change, self._count, self._forking = threading.Condition(), 0, False

    def __enter__(self) -> None:
        with self._change:
            self._change.wait_for(lambda: not self._forking)
            self._count += 1

    def __exit__(self, *_fault: object) -> None:
        with self._change:
            self._count -= 1
            self._change.notify_all()

    def stop(self) -> None:
        """Until nobody talks, nor begins to."""
        with self._change:
            self._forking = True
            self._change.wait_for(lambda: self._count == 0)

    def go_on(self) -> None:
        with self._change:
            self._forking = False
            self._change.notify_all()


_systems: dict[tuple[str | None, ...], Any] = {}
_inherited: list[dict[tuple[str | None, ...], Any]] = []
_lock = threading.Lock()
_talks = _Talks()


def talk() -> _Talks:
    """Whoever asks a service does so `with talk()`, which must not be nested."""
    return _talks


def _begin_anew() -> None:
    """A forked child makes its own: connections that both used would mix their answers up. What it inherited is
    not let go of either, which would say good-bye on connections that the parent goes on to use."""
    global _systems, _lock, _talks
    _inherited.append(_systems)
    _systems, _lock, _talks = {}, threading.Lock(), _Talks()


os.register_at_fork(before=lambda: _talks.stop(), after_in_parent=lambda: _talks.go_on(), after_in_child=_begin_anew)


def system(scheme: str) -> Any:
    """The `pyarrow.fs` file system of a scheme, one a process as long as the variables stay."""
    key = (scheme, *(os.environ.get(name) for name in _VARIABLES[scheme]))
    with _lock:
        if key not in _systems:
            try:
                _systems[key] = _MAKE[scheme]()
            except (pa.ArrowException, OSError, ValueError) as fault:
                # Its words may hold what a variable says, and so a secret.
                raise StoreError(
                    f"pyarrow makes no file system for {scheme}:// of the environment ({type(fault).__name__})",
                    do=f"check {_ACCESS[scheme]}",
                ) from None
        return _systems[key]


def explain(fault: BaseException, scheme: str, bucket: str) -> tuple[str, str] | None:
    """What a fault of the service means, and what to do; None for one of a single object."""
    # Without names of objects, which may have any words in them.
    text = re.sub(r"'[^']*'", "", " ".join(str(fault).split()))
    code = _CODE.search(text)
    said = f" ({next(group for group in code.groups() if group)})" if code else ""
    if isinstance(fault, FileNotFoundError) or not isinstance(fault, OSError):
        return None
    if _ELSEWHERE.search(text):
        return f"bucket {bucket} is in another region than was asked{said}", "set AWS_REGION to that of the bucket"
    # First, as an endpoint that does not answer is one that gives no credentials, too.
    if re.search("NETWORK_CONNECTION|curl", text) or (_AWAY.search(text) and not _REFUSED.search(text)):
        return f"{_endpoint(scheme)} does not answer{said}", f"try again later, or check {_address(scheme)}"
    if _REFUSED.search(text):
        return f"the credentials for bucket {bucket} are refused{said}", f"check {_ACCESS[scheme]}, and what they allow"
    return None


def _endpoint(scheme: str) -> str:
    if scheme == "s3":
        place = _s3_endpoint()
        return f"the endpoint {place[0]}://{place[1]}" if place else "Amazon S3"
    return {"gs": "Google Cloud Storage", "az": "Azure Blob Storage"}[scheme]


def _address(scheme: str) -> str:
    return {"s3": "AWS_ENDPOINT_URL and AWS_REGION", "gs": "the network", "az": "AZURE_STORAGE_ACCOUNT_NAME"}[scheme]


def _is_true(name: str) -> bool:
    return os.environ.get(name, "").lower() in ("1", "true", "yes", "on")


def _known(scheme: str, name: str) -> Any:
    """A class of `pyarrow.fs`, which not every build has."""
    try:
        import pyarrow.fs

        return getattr(pyarrow.fs, name)
    except (ImportError, AttributeError):
        raise StoreError(
            f"pyarrow {pa.__version__} as it is installed here knows no {scheme}://",
            do="install a newer pyarrow from PyPI",
        ) from None


def _profile(key: str) -> str | None:
    """What the profile says that AWS_PROFILE names, or `default`: pyarrow takes keys alone from it."""
    files = {"AWS_SHARED_CREDENTIALS_FILE": "~/.aws/credentials", "AWS_CONFIG_FILE": "~/.aws/config"}
    name, said = os.environ.get("AWS_PROFILE") or "default", configparser.RawConfigParser(strict=False)
    try:
        said.read([os.path.expanduser(os.environ.get(variable) or file) for variable, file in files.items()])
    except (configparser.Error, UnicodeDecodeError):
        return None  # Whoever needs the file for its keys complains of it.
    return next((said[part].get(key) for part in (name, f"profile {name}") if said.has_option(part, key)), None)


def _s3_endpoint() -> tuple[str, str] | None:
    """Scheme and address, if it is not Amazon's own."""
    given = os.environ.get("AWS_ENDPOINT_URL_S3") or os.environ.get("AWS_ENDPOINT_URL") or _profile("endpoint_url")
    if not given:
        return None
    scheme, found, address = given.strip().partition("://")
    if not found:
        scheme, address = ("http" if _is_true("AWS_ALLOW_HTTP") else "https"), given.strip()
    address = address.rstrip("/")
    if scheme not in ("http", "https") or not address or "@" in address or "?" in address:
        raise StoreError(
            "AWS_ENDPOINT_URL, or that of the profile, is no address",
            do="give http://HOST:PORT or https://HOST, without credentials",
        )
    return scheme, address


def _s3() -> Any:
    make = _known("s3", "S3FileSystem")
    # Keys, session tokens and profiles are found by Amazon's own library, which knows these variables; with half
    # a key it would go on to look in other places, and wait there.
    if bool(os.environ.get("AWS_ACCESS_KEY_ID")) != bool(os.environ.get("AWS_SECRET_ACCESS_KEY")):
        raise StoreError(
            "only one of AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY is set", do="set both, or neither of them"
        )
    from pyarrow.fs import AwsStandardS3RetryStrategy

    options: dict[str, Any] = {"retry_strategy": AwsStandardS3RetryStrategy(max_attempts=ATTEMPTS)}
    options |= {"connect_timeout": 10.0, "request_timeout": 30.0}
    endpoint = _s3_endpoint()
    if endpoint is not None:
        options |= {"scheme": endpoint[0], "endpoint_override": endpoint[1]}
    if _is_true("AWS_SKIP_SIGNATURE"):
        options["anonymous"] = True
    region = os.environ.get("AWS_REGION") or os.environ.get("AWS_DEFAULT_REGION") or _profile("region")
    if region or endpoint is not None:
        # Servers that are not Amazon's take any; without one the library would ask the machine it runs on.
        options["region"] = region or "us-east-1"
    return make(**options)


def _gs() -> Any:
    make = _known("gs", "GcsFileSystem")
    options: dict[str, Any] = {"retry_time_limit": datetime.timedelta(seconds=SECONDS)}
    if emulator := os.environ.get("STORAGE_EMULATOR_HOST"):
        scheme, found, address = emulator.partition("://")
        options |= {"anonymous": True, "scheme": scheme if found else "http"}
        options["endpoint_override"] = (address if found else emulator).rstrip("/")
    return make(**options)


def _az() -> Any:
    make = _known("az", "AzureFileSystem")
    account, key = os.environ.get("AZURE_STORAGE_ACCOUNT_NAME"), os.environ.get("AZURE_STORAGE_ACCOUNT_KEY")
    token = os.environ.get("AZURE_STORAGE_SAS_TOKEN")
    options: dict[str, Any] = {}
    if _is_true("AZURE_STORAGE_USE_EMULATOR"):
        # Azurite, with the account and the key that everybody has.
        account = account or "devstoreaccount1"
        key = key or "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw=="
        for kind in ("blob", "dfs"):
            options |= {f"{kind}_storage_authority": "127.0.0.1:10000", f"{kind}_storage_scheme": "http"}
    if not account:
        raise StoreError("an az:// URL names no account", do="set AZURE_STORAGE_ACCOUNT_NAME")
    if key:
        try:
            base64.b64decode(key, validate=True)
        except ValueError:
            # pyarrow would end the process.
            raise StoreError("AZURE_STORAGE_ACCOUNT_KEY is no key", do="give it in Base64, as Azure shows it") from None
        options["account_key"] = key
    elif token:
        # It is appended to URLs as it is.
        options["sas_token"] = "?" + token.removeprefix("?")
    try:
        return make(account, **options)
    except TypeError:
        raise StoreError(
            f"pyarrow {pa.__version__} takes no AZURE_STORAGE_SAS_TOKEN",
            do="install a newer pyarrow, or set AZURE_STORAGE_ACCOUNT_KEY",
        ) from None


_MAKE: dict[str, Callable[[], Any]] = {"s3": _s3, "gs": _gs, "az": _az}
