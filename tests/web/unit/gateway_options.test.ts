import { expect, test } from 'vitest';
import { hostAllowed, parseOptions, UsageError } from '../../../client/web/gateway/options';

const parse = (...args: string[]) => {
  const options = parseOptions(args, { CCST_SERVER: '127.0.0.1:1' });
  if (options === 'help') throw new Error('help');
  return options;
};

test('Options.Defaults stay on this machine', () => {
  expect(parse()).toMatchObject({ host: '127.0.0.1', port: 8080, server: 'http://127.0.0.1:1' });
  expect(parse('--server', 'a:2', '--server-tls').server).toBe('https://a:2');
});

test.each([
  [['--listen', '0.0.0.0:80']],
  [['--listen', '8080']],
  [['--listen', '127.0.0.1:99999']],
  [['--tls-cert', 'a.pem']],
  [['--server', '10.0.0.1:50051']],
  [['--server', 'nowhere']],
  [['--max-message-mib', '0']],
  [['--max-message-mib', '1.5']],
  [['--max-message-mib', '4096']],
  [['--colour', 'red']],
])('Options.%j is refused', (args) => {
  expect(() => parse(...args)).toThrow(UsageError);
});

test('Options.What is under way has room for two of the largest messages', () => {
  expect(parse('--max-message-mib', '3')).toMatchObject({
    maxMessageBytes: 3 * 1024 * 1024,
    maxBytesUnderWay: 6 * 1024 * 1024,
  });
});

test('Options.Other machines may connect when that is said', () => {
  expect(parse('--listen', '0.0.0.0:80', '--insecure').host).toBe('0.0.0.0');
});

test('HostAllowed.Loopback answers to its own names alone', () => {
  const options = parse();
  expect(hostAllowed('localhost:8080', options)).toBe(true);
  expect(hostAllowed('[::1]:8080', options)).toBe(true);
  expect(hostAllowed('rebound.example:8080', options)).toBe(false);
  expect(hostAllowed(undefined, options)).toBe(false);
});

test('HostAllowed.Names that were given are answered', () => {
  const options = parse('--listen', '0.0.0.0:80', '--insecure', '--allow-host', 'points.example');
  expect(hostAllowed('points.example', options)).toBe(true);
  expect(hostAllowed('192.168.1.2:80', options)).toBe(true);
  expect(hostAllowed('other.example', options)).toBe(false);
});
