#include "server/jobs/memory_estimate.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr std::int64_t kMebibyte = std::int64_t{1} << 20;
// Threads, queues, small arrays, and texts of an image, which libspng keeps.
constexpr std::int64_t kFixed = 8 * kMebibyte;

// Repair and the surface with its search structures; a vertex is copied with them.
constexpr std::int64_t kSurfaceFace = 220;
constexpr std::int64_t kSurfaceVertex = 8;
// Faces that are cut at creases, at worst each of them.
constexpr std::int64_t kCreaseFace = 420;
// A density that is linear over faces, and one of texture coordinates.
constexpr std::int64_t kLinearFace = 30;
constexpr std::int64_t kTexturedFace = 95;
// Of an image after it is decoded: itself, and the pyramid made of it, a third larger.
constexpr std::int64_t kPixelTenths = 94;
// Means over the parts of faces, at most: core/density/density.cc bounds their number.
constexpr std::int64_t kMostMeans = 24 * kMebibyte;
constexpr std::int64_t kMeansFace = 90'000 * 4;

// Bytes of a sample while a method works.
std::int64_t SampleBytes(SamplingMethod method) {
  switch (method) {
    case SamplingMethod::kCcst:
      return 400;
    case SamplingMethod::kWhiteNoise:
      return 250;
    case SamplingMethod::kPoissonDisk:
      return 1900;
    case SamplingMethod::kSampleElimination:
      return 1250;
    case SamplingMethod::kLloyd:
      return 1250;
    case SamplingMethod::kCcvt:
      return 9200;
  }
  return 0;
}

std::int64_t DensityBytes(const InputCounts& input, const DensityOptions& density) {
  const std::int64_t faces = input.mesh.faces;
  switch (density.source) {
    case DensitySource::kUniform:
      return 0;
    case DensitySource::kAttribute:
    case DensitySource::kCurvature:
      return kLinearFace * faces;
    case DensitySource::kTexture:
      break;
  }
  const std::int64_t pixels = input.image.width * input.image.height;
  return kTexturedFace * faces + kPixelTenths * pixels / 10 +
         std::min(kMostMeans, kMeansFace * faces);
}

// Until mesh and image are decoded: the mesh first, from its bytes, then the image beside it.
std::int64_t DecodingBytes(const InputCounts& input) {
  const MeshCounts& mesh = input.mesh;
  return std::max(mesh.encoded_bytes + mesh.decoder_bytes + mesh.mesh_bytes,
                  mesh.mesh_bytes + input.encoded_image_bytes + input.image.decode_bytes);
}

// What was measured, and a tenth.
std::int64_t WithMargin(std::int64_t bytes) { return bytes + bytes / 10; }

// The blob as a source, which holds it.
ByteSource SourceOf(std::shared_ptr<const Blob> blob) {
  const std::int64_t size = blob->size_bytes();
  return {.size = size, .read = [blob = std::move(blob)](std::int64_t offset, std::span<char> out) {
            return blob->Read(offset, out);
          }};
}

}  // namespace

std::int64_t EstimateUpload(const MeshCounts& mesh) {
  constexpr std::int64_t kMeasuredFace = 150;
  return kFixed + WithMargin(std::max(DecodingBytes({.mesh = mesh}),
                                      mesh.mesh_bytes + kMeasuredFace * mesh.faces));
}

std::int64_t EstimateJob(const InputCounts& input, const SamplingOptions& options) {
  const MeshCounts& mesh = input.mesh;
  const std::int64_t sampling =
      mesh.mesh_bytes + kSurfaceFace * mesh.faces + kSurfaceVertex * mesh.vertices +
      (options.crease_angle.has_value() ? kCreaseFace * mesh.faces : 0) +
      DensityBytes(input, options.density) +
      (SampleBytes(options.method) + mesh.sample_bytes) * options.sample_count;
  return kFixed + std::max(WithMargin(DecodingBytes(input)), sampling);
}

std::int64_t EstimateAnalysis(const InputCounts& input, const DensityOptions& density,
                              std::int64_t sample_count) {
  // The samples as they are read; a surface with what is measured on it; then, without the mesh,
  // the pairs of samples and the transforms, which have a size of their own.
  constexpr std::int64_t kReadSample = 130;
  constexpr std::int64_t kReferenceFace = 330;
  constexpr std::int64_t kDensityFace = 130;
  constexpr std::int64_t kMeasuredSample = 400;
  constexpr std::int64_t kTransforms = 24 * kMebibyte;
  const MeshCounts& mesh = input.mesh;
  const bool is_uniform = density.source == DensitySource::kUniform;
  const std::int64_t surface = kReferenceFace * mesh.faces +
                               (is_uniform ? 0 : kDensityFace * mesh.faces) +
                               DensityBytes(input, density);
  return kFixed + (kReadSample + mesh.sample_bytes) * sample_count +
         std::max({WithMargin(DecodingBytes(input)), mesh.mesh_bytes + surface,
                   surface + kTransforms + kMeasuredSample * sample_count});
}

absl::StatusOr<MeshCounts> CountMesh(const BlobStore& blobs, const std::string& sha256,
                                     const RunDependencies& dependencies) {
  auto opened = blobs.Open(sha256);
  if (absl::IsNotFound(opened.status())) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshMissing,
                     "the mesh meshes/" + sha256 + " is not stored");
  }
  if (!opened.ok()) return opened.status();
  auto counts = dependencies.count(SourceOf(*std::move(opened)), dependencies.mesh_limits);
  // What does not announce anything may be damaged, which is no fault of the request.
  if (!counts.ok()) CCST_RETURN_IF_ERROR(blobs.Check(sha256));
  return counts;
}

absl::StatusOr<InputCounts> CountInput(const BlobStore& blobs, const JobSpec& spec,
                                       const RunDependencies& dependencies,
                                       const std::shared_ptr<const HeldInput>& held) {
  InputCounts input;
  if (held != nullptr) {
    CCST_ASSIGN_OR_RETURN(input.mesh, dependencies.count(SourceOf(HeldInput::AsBlob(held)),
                                                         dependencies.mesh_limits));
  } else {
    CCST_ASSIGN_OR_RETURN(input.mesh, CountMesh(blobs, spec.mesh_sha256, dependencies));
  }
  if (spec.texture_sha256.empty()) return input;
  std::shared_ptr<const Blob> image;
  CCST_ASSIGN_OR_RETURN(image, blobs.Open(spec.texture_sha256));
  input.encoded_image_bytes = image->size_bytes();
  CCST_ASSIGN_OR_RETURN(input.image, dependencies.image_facts(SourceOf(std::move(image))));
  return input;
}

}  // namespace ccst::server
