"""Runs many jobs after each other and measures whether the server's memory keeps growing."""

import draco

from harness import Client, Folder, Report, Server, arguments, options, sampling_service_pb2


def run_jobs(client, data, count, first_seed):
    for seed in range(first_seed, first_seed + count):
        request = sampling_service_pb2.SampleRequest(
            options=options(300, seed, max_iterations=5), skip_cache_lookup=True,
            preview_sample_count=100)
        request.inline_mesh.format = 1
        request.inline_mesh.data = data
        for _ in client.call(client.jobs.Sample, request):
            pass


def main():
    args = arguments(__doc__, jobs=100, server="", growth_percent=5.0)
    report = Report()
    warm_up = args.jobs // 4
    with Folder() as folder, Server(folder, program=args.server or None) as server, \
            Client(server.address) as client:
        data = draco.encode(*draco.torus(48, 24))
        run_jobs(client, data, warm_up, 0)
        before = server.resident_bytes()
        run_jobs(client, data, args.jobs - warm_up, warm_up)
        growth = server.resident_bytes() - before
        report.figure("memory after the warm-up", f"{before / 2**20:.1f} MiB")
        report.figure("growth a job", f"{growth / (args.jobs - warm_up):.0f} bytes")
        report.threshold(f"growth over {args.jobs - warm_up} jobs", 100.0 * growth / before,
                         args.growth_percent, "%")
        # A server built with the address sanitizer exits with an error when it leaked.
        code = server.stop()
        report.check(code == 0, f"the server drains and exits with 0 (it was {code})")
        if code != 0:
            print(server.log()[-4000:])
    report.exit()


if __name__ == "__main__":
    main()
