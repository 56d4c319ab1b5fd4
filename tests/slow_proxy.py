"""A proxy that lets every request of HTTP wait, and counts them: slow_proxy.py PORT TARGET_PORT DELAY_MS.

When it is ended it prints how many requests of each method there were, bytes to the service and from it, and how many
connections.
"""

import asyncio
import collections
import contextlib
import signal
import sys

PIECE = 1 << 18


class Proxy:
    def __init__(self, target, delay_s):
        self.target, self.delay_s = target, delay_s
        self.methods = collections.Counter()
        self.sent = self.received = self.connections = 0

    async def converse(self, reader, writer):
        self.connections += 1
        try:
            answers, requests = await asyncio.open_connection("127.0.0.1", self.target)
        except OSError:
            writer.close()
            return
        # Whether the last that passed was an answer: what the client sends next begins a request.
        state = {"answered": True}
        with contextlib.suppress(OSError, asyncio.CancelledError):
            await asyncio.gather(self.up(reader, requests, state), self.down(answers, writer, state))

    async def up(self, reader, writer, state):
        while piece := await reader.read(PIECE):
            if state["answered"]:
                state["answered"] = False
                self.methods[piece.split(b" ", 1)[0].decode()] += 1
                await asyncio.sleep(self.delay_s)
            self.sent += len(piece)
            writer.write(piece)
            await writer.drain()
        writer.close()

    async def down(self, reader, writer, state):
        while piece := await reader.read(PIECE):
            state["answered"] = True
            self.received += len(piece)
            writer.write(piece)
            await writer.drain()
        writer.close()


async def main(port, target, delay_ms):
    proxy = Proxy(target, delay_ms / 1000)
    server = await asyncio.start_server(proxy.converse, "127.0.0.1", port)
    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    async with server:
        await ended.wait()
        methods = ", ".join(f"{count} {method}" for method, count in sorted(proxy.methods.items()))
        print(f"{methods}; {proxy.sent / 1e6:.1f} MB sent, {proxy.received / 1e6:.1f} MB received, "
              f"{proxy.connections} connections", flush=True)
        for task in asyncio.all_tasks() - {asyncio.current_task()}:
            task.cancel()


if __name__ == "__main__":
    asyncio.run(main(*map(int, sys.argv[1:4])))
