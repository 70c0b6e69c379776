"""Stores many jobs and measures how long the next start takes until the server answers."""

import itertools
import threading
import time

import draco

from harness import WHITE_NOISE, Client, Folder, Report, Server, arguments, server_info_service_pb2, spec


def create_all(client, mesh, count, callers=8):
    """`count` ended jobs: after the first, all from the cache."""
    numbers = itertools.count()
    errors = []

    def work():
        try:
            while next(numbers) < count:
                client.create(spec(mesh, 4, method=WHITE_NOISE))
        except Exception as error:  # pylint: disable=broad-except
            errors.append(error)

    client.wait(client.create(spec(mesh, 4, method=WHITE_NOISE)).name)
    threads = [threading.Thread(target=work) for _ in range(callers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]


def main():
    args = arguments(__doc__, jobs=1000, seconds=2.0)
    report = Report()
    with Folder() as folder:
        with Server(folder) as server, Client(server.address) as client:
            mesh = client.upload(draco.encode(*draco.torus())).name
            begin = time.monotonic()
            create_all(client, mesh, args.jobs)
            seconds = time.monotonic() - begin
            report.figure("jobs stored", f"{args.jobs}, {args.jobs / seconds:.0f} a second")
            server.kill()
        begin = time.monotonic()
        with Server(folder) as server, Client(server.address) as client:
            client.call(client.info.GetServerInfo, server_info_service_pb2.GetServerInfoRequest())
            report.threshold("from start to first answer", time.monotonic() - begin, args.seconds,
                             "s")
            report.figure("memory after the start", f"{server.resident_bytes() >> 20} MiB")
    report.exit()


if __name__ == "__main__":
    main()
