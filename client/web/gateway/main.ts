import { startGateway } from './gateway';
import { parseOptions, usage, UsageError } from './options';

// Exit codes as those of ccst-server: 1 a wrong setting, 2 the address cannot be had.
try {
  const options = parseOptions(process.argv.slice(2), process.env);
  if (options === 'help') {
    process.stdout.write(usage);
  } else {
    const gateway = await startGateway(options);
    process.stdout.write(`dashboard on ${gateway.url}\n`);
    for (const signal of ['SIGINT', 'SIGTERM'] as const) {
      process.once(signal, () => void gateway.close().then(() => process.exit(0)));
    }
  }
} catch (error) {
  process.stderr.write(`ccst-gateway: ${(error as Error).message}\n`);
  process.exit(error instanceof UsageError ? 1 : 2);
}
