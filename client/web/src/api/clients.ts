import { createClient, type Interceptor } from '@connectrpc/connect';
import { createConnectTransport } from '@connectrpc/connect-web';
import { MeshService } from '@api/mesh_service_pb';
import { SamplingService } from '@api/sampling_service_pb';
import { ServerInfoService } from '@api/server_info_service_pb';
import { currentToken } from './token';

const withToken: Interceptor = (next) => (request) => {
  const token = currentToken();
  if (token !== null) request.header.set('authorization', `Bearer ${token}`);
  return next(request);
};

const transport = createConnectTransport({
  baseUrl: location.origin,
  useBinaryFormat: true,
  interceptors: [withToken],
});

/** The public API, through the gateway that served the page. */
export const jobsApi = createClient(SamplingService, transport);
export const meshesApi = createClient(MeshService, transport);
export const serverApi = createClient(ServerInfoService, transport);
