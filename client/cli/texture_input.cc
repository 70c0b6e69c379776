#include "client/cli/texture_input.h"

#include <cstdint>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/image_file.h"
#include "core/io/whole_file.h"

namespace ccst::cli {
namespace {

constexpr std::int64_t kMaxTextureBytes = std::int64_t{256} << 20;

}  // namespace

absl::Status ReadTexture(const std::string& path, DensityOptions& density) {
  CCST_ASSIGN_OR_RETURN(std::string bytes, io::ReadWholeFile(path, kMaxTextureBytes));
  absl::StatusOr<Image> image = DecodeImage(bytes);
  if (!image.ok()) {
    return MakeError(image.status().code(),
                     GetErrorReason(image.status()).value_or(ErrorReason::kImageUnreadable),
                     absl::StrCat(path, ": ", image.status().message()));
  }
  density.image = std::make_shared<const Image>(*std::move(image));
  density.encoded_image = std::make_shared<const std::string>(std::move(bytes));
  return absl::OkStatus();
}

}  // namespace ccst::cli
