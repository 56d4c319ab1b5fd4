"""A server of S3, by moto, which counts what it is asked and may be told to fail.

It is a process of its own (`python3 bucket.py` is it, and tells its port): a child that the tests fork would hold its connections.
"""

import http.client
import json
import os
import subprocess
import sys
from unittest import mock

VARIABLES = {
    "AWS_ACCESS_KEY_ID": "somebody",
    "AWS_SECRET_ACCESS_KEY": "hush-hush",
    "AWS_REGION": "us-east-1",
    "AWS_EC2_METADATA_DISABLED": "true",
}


def variables(**changes):
    """The environment without what it may know of clouds, and with these; until it is stopped."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("AWS_", "AZURE_", "GOOGLE_", "STORAGE_"))}
    # Profiles of whoever runs the tests would say where Amazon is.
    none = {"AWS_CONFIG_FILE": "/no/such", "AWS_SHARED_CREDENTIALS_FILE": "/no/such"}
    return mock.patch.dict(os.environ, kept | none | changes, clear=True)


class Server:
    """Raises ImportError without moto."""

    def __init__(self):
        import moto.server  # noqa: F401

        command = [sys.executable, __file__]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = int(self._process.stdout.readline())
        self.url = f"http://127.0.0.1:{self.port}"

    def close(self):
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.wait()

    def put(self, path, data=b""):
        """Makes a bucket or an object, or removes one."""
        self._ask("PUT" if data is not None else "DELETE", path, data)

    def fail(self, status=None, code=None):
        """Answers everything so from now on, or again as it should."""
        self._ask("POST", "_tests/fail", json.dumps([status, code]))

    def requests(self, read):
        """What a call asks the server, as methods: H is HEAD, G is GET, L is a list."""
        self._ask("POST", "_tests/asked")
        read()
        return "".join(json.loads(self._ask("POST", "_tests/asked"))["methods"])

    def users(self, read):
        """By which keys a call asks."""
        self._ask("POST", "_tests/asked")
        read()
        return set(json.loads(self._ask("POST", "_tests/asked"))["users"])

    def _ask(self, method, path, data=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port)
        # Nobody looks at the signature, but anonymous people may replace nothing.
        signed = "AWS4-HMAC-SHA256 Credential=tests/20260101/us-east-1/s3/aws4_request, SignedHeaders=host, Signature=0"
        connection.request(method, f"/{path}", data, {"Authorization": signed})
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        assert answer.status < 300, (method, path, answer.status, text)
        return text


def serve():
    """The server, until its standard input ends."""
    import threading

    from moto.server import DomainDispatcherApplication, create_backend_app
    from werkzeug.serving import WSGIRequestHandler, make_server

    class Quiet(WSGIRequestHandler):
        protocol_version = "HTTP/1.1"

        def log(self, *_args, **_options):
            pass

    real, asked, failing = DomainDispatcherApplication(create_backend_app), [], []

    def say(start, status, text):
        start(status, [("Content-Type", "application/xml"), ("Content-Length", str(len(text)))])
        return [text]

    def answer(request, start):
        path = request["PATH_INFO"]
        if path == "/_tests/fail":
            status, code = json.loads(request["wsgi.input"].read(int(request["CONTENT_LENGTH"])))
            failing[:] = [(status, f"<Error><Code>{code}</Code><Message>It is\nso.</Message></Error>".encode())]
            return say(start, "200 OK", b"")
        if path == "/_tests/asked":
            methods, users = ([entry[i] for entry in asked] for i in (0, 1))
            asked.clear()
            return say(start, "200 OK", json.dumps({"methods": methods, "users": users}).encode())
        method = "L" if "list-type=2" in request["QUERY_STRING"] else request["REQUEST_METHOD"][0]
        asked.append((method, request.get("HTTP_AUTHORIZATION", "").partition("Credential=")[2].partition("/")[0]))
        if failing and failing[0][0]:
            return say(start, *failing[0])
        return real(request, start)

    server = make_server("127.0.0.1", 0, answer, threaded=True, request_handler=Quiet)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print(server.server_port, flush=True)
    sys.stdin.read()


if __name__ == "__main__":
    serve()
