#include "core/io/draco_announced.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/byte_reader.h"
#include "core/io/io_errors.h"
#include "draco/attributes/geometry_attribute.h"
#include "draco/compression/config/compression_shared.h"
#include "draco/compression/entropy/rans_symbol_decoder.h"
#include "draco/core/decoder_buffer.h"
#include "draco/core/draco_types.h"

namespace ccst::io {
namespace {

// Passes over the parts of a stream of one version.
class Connectivity {
 public:
  Connectivity(const DracoHeader& header, ByteReader& stream)
      : header_(header),
        stream_(stream),
        version_(header.version_major * 100 + header.version_minor) {}

  void Skip() {
    if (header_.method == DracoMethod::kSequential) return SkipSequential();
    if (version_ >= 202) {
      SkipSplits();
      return SkipTraversal();
    }
    // The splits stand behind the traversal, at a place that stands before it.
    const std::uint32_t size = Count();
    const std::int64_t begin = stream_.position();
    SkipTraversal();
    const std::int64_t end = stream_.position();
    stream_.MoveTo(begin + size);
    SkipSplits();
    stream_.MoveTo(end + (stream_.position() - (begin + size)));
  }

 private:
  std::uint32_t Count() {
    return version_ < 200 ? stream_.Fixed<std::uint32_t>() : stream_.Varint32();
  }

  void SkipSequential() {
    const std::int64_t indices = 3 * header_.faces;
    if (header_.compressed_indices) return SkipSymbols(indices);
    if (header_.points < 256) return stream_.Skip(static_cast<std::uint64_t>(indices));
    if (header_.points < 65536) return stream_.Skip(static_cast<std::uint64_t>(2 * indices));
    if (version_ < 202 || header_.points >= 1 << 21) {
      return stream_.Skip(static_cast<std::uint64_t>(4 * indices));
    }
    for (std::int64_t i = 0; i < indices && !stream_.failed(); ++i) stream_.Varint32();
  }

  void SkipSplits() {
    const std::uint32_t splits = Count();
    if (splits > header_.faces) return stream_.Fail();
    if (version_ < 102) {
      stream_.Skip(9 * std::uint64_t{splits});
    } else {
      for (std::uint32_t i = 0; i < 2 * splits && !stream_.failed(); ++i) stream_.Varint32();
      const int bits = version_ < 202 ? 2 : 1;
      stream_.Skip((std::uint64_t{splits} * bits + 7) / 8);
    }
    if (version_ >= 201) return;
    const std::uint32_t holes = Count();
    if (version_ < 102) return stream_.Skip(4 * std::uint64_t{holes});
    for (std::uint32_t i = 0; i < holes && !stream_.failed(); ++i) stream_.Varint32();
  }

  void SkipTraversal() {
    constexpr int kPredictive = 1;
    constexpr int kValence = 2;
    const bool valence = header_.traversal == kValence;
    if (!valence || version_ < 202) SkipBits();
    if (version_ < 202) {
      SkipBits();
    } else {
      SkipCodedBits();
    }
    for (std::int64_t i = 0; i < header_.attribute_connectivities; ++i) SkipCodedBits();
    if (header_.traversal == kPredictive) {
      stream_.Fixed<std::int32_t>();
      SkipCodedBits();
    }
    if (valence) SkipValences();
  }

  void SkipValences() {
    constexpr int kContexts = 6;  // Valences 2 to 7.
    if (version_ < 202) {
      Count();
      stream_.Fixed<std::int8_t>();
    }
    for (int i = 0; i < kContexts; ++i) SkipSymbols(static_cast<std::int64_t>(stream_.Varint32()));
  }

  // Plain bits with their size in front.
  void SkipBits() {
    stream_.Skip(version_ < 202 ? stream_.Fixed<std::uint64_t>() : stream_.Varint64());
  }

  // Bits that are coded, behind their probability and size.
  void SkipCodedBits() {
    stream_.Fixed<std::uint8_t>();
    stream_.Skip((version_ < 202 ? stream_.Fixed<std::uint32_t>() : stream_.Varint32()));
  }

  // Coded symbols, behind the table of their probabilities and their size.
  void SkipCodedSymbols() {
    const std::uint32_t symbols = Count();
    // A byte stands for at most 64 of them.
    if (symbols / 64 > stream_.remaining()) return stream_.Fail();
    for (std::uint32_t i = 0; i < symbols && !stream_.failed(); ++i) {
      const auto byte = stream_.Fixed<std::uint8_t>();
      constexpr int kRun = 3;
      if ((byte & 3) == kRun) {
        i += byte >> 2;
      } else {
        stream_.Skip(byte & 3);
      }
    }
    stream_.Skip(version_ < 200 ? stream_.Fixed<std::uint64_t>() : stream_.Varint64());
  }

  void SkipSymbols(std::int64_t count) {
    constexpr int kTagged = 0;
    constexpr int kRaw = 1;
    if (count == 0 || stream_.failed()) return;
    const auto scheme = stream_.Fixed<std::uint8_t>();
    if (scheme == kRaw) {
      stream_.Fixed<std::uint8_t>();  // The longest symbol.
      return SkipCodedSymbols();
    }
    if (scheme != kTagged) return stream_.Fail();
    const std::int64_t begin = stream_.position();
    SkipCodedSymbols();
    const std::string tags = stream_.Between(begin, stream_.position());
    stream_.Skip((BitsOfTags(tags, count) + 7) / 8);
  }

  // The sum of the lengths that the tags say, which only decoding tells.
  std::uint64_t BitsOfTags(const std::string& tags, std::int64_t count) {
    constexpr int kBits = 5;
    constexpr std::uint32_t kLongest = 32;
    draco::DecoderBuffer buffer;
    buffer.Init(tags.data(), tags.size(),
                DRACO_BITSTREAM_VERSION(header_.version_major, header_.version_minor));
    draco::RAnsSymbolDecoder<kBits> decoder;
    if (stream_.failed() || !decoder.Create(&buffer) || !decoder.StartDecoding(&buffer) ||
        decoder.num_symbols() == 0) {
      stream_.Fail();
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::uint32_t length = decoder.DecodeSymbol();
      if (length > kLongest) stream_.Fail();
      bits += length;
    }
    decoder.EndDecoding();
    return stream_.failed() ? 0 : bits;
  }

  const DracoHeader& header_;
  ByteReader& stream_;
  const int version_;
};

// The table of attributes, decoder by decoder.
void ReadAttributes(const DracoHeader& header, ByteReader& stream,
                    std::vector<DracoListedAttribute>& attributes) {
  const int version = header.version_major * 100 + header.version_minor;
  const bool is_edgebreaker = header.method == DracoMethod::kEdgebreaker;
  constexpr std::uint8_t kByCorner = 1;
  const auto decoders = stream.Fixed<std::uint8_t>();
  std::vector<bool> by_corner(decoders, false);
  for (std::size_t i = 0; i < decoders && is_edgebreaker; ++i) {
    stream.Fixed<std::int8_t>();
    by_corner[i] = stream.Fixed<std::uint8_t>() == kByCorner;
    if (version >= 102) stream.Fixed<std::uint8_t>();
  }
  for (std::size_t d = 0; d < decoders && !stream.failed(); ++d) {
    const std::uint32_t count = version < 200 ? stream.Fixed<std::uint32_t>() : stream.Varint32();
    // Each takes five bytes here, and one below.
    if (count == 0 || count > stream.remaining() / 5) return stream.Fail();
    const std::size_t first = attributes.size();
    for (std::uint32_t i = 0; i < count; ++i) {
      DracoListedAttribute attribute;
      attribute.type = stream.Fixed<std::uint8_t>();
      const auto number = static_cast<draco::DataType>(stream.Fixed<std::uint8_t>());
      attribute.number_bytes = std::max(0, draco::DataTypeLength(number));
      attribute.components = stream.Fixed<std::uint8_t>();
      stream.Fixed<std::uint8_t>();  // Whether it is normalised.
      if (version < 103) {
        stream.Fixed<std::uint16_t>();
      } else {
        stream.Varint32();
      }
      attribute.has_seams = by_corner[d];
      attributes.push_back(attribute);
    }
    constexpr int kGeneric = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      attributes[first + i].as_integers = stream.Fixed<std::uint8_t>() != kGeneric;
    }
  }
}

// Streams of ours that split vertices say so in an attribute of bytes; any attribute may then
// differ between the corners of a vertex.
bool MaySplit(const DracoListedAttribute& attribute) {
  return attribute.type == draco::GeometryAttribute::GENERIC && attribute.components == 1 &&
         attribute.number_bytes == 1;
}

// What Draco allocates, and what it takes to make a mesh of it, measured on both methods. A face of
// a sequential stream: its corners, and indices of 32 bits where they are coded. Of Edgebreaker:
// the corner table, marks and queues of the traversal; and for each connectivity of attributes its
// own.
constexpr std::int64_t kSequentialFace = 12;
constexpr std::int64_t kCodedFace = 12;
constexpr std::int64_t kEdgebreakerFace = 44;
constexpr std::int64_t kSeamFace = 40;
constexpr std::int64_t kBytesPerPoint = 8;
constexpr std::int64_t kMapBytes = 4;  // From a point to its value.
constexpr std::int64_t kMeshBytesPerFace = 12;
constexpr std::int64_t kMeshBytesPerVertex = 24;

std::int64_t BaseBytes(const DracoHeader& header) {
  if (header.method == DracoMethod::kSequential) {
    return (kSequentialFace + (header.compressed_indices ? kCodedFace : 0)) * header.faces;
  }
  return (kEdgebreakerFace + kSeamFace * header.attribute_connectivities) * header.faces +
         kBytesPerPoint * header.split_symbols;
}

// The values, and the integers that they come from.
std::int64_t AttributeBytes(const DracoListedAttribute& attribute, std::int64_t values) {
  const int integer = attribute.as_integers ? 4 : 0;
  return values * attribute.components * (attribute.number_bytes + integer);
}

// True for those that become part of the mesh, as FromDraco() chooses them.
bool IsCarried(const DracoListedAttribute& attribute) {
  using Type = draco::GeometryAttribute;
  if (attribute.components < 1 || attribute.components > 4) return false;
  return attribute.type == Type::COLOR || attribute.type == Type::TEX_COORD ||
         attribute.type == Type::GENERIC;
}

}  // namespace

absl::StatusOr<DracoAnnouncement> ReadDracoAnnouncement(const ByteSource& source,
                                                        const MeshLimits& limits) {
  DracoAnnouncement announced;
  CCST_ASSIGN_OR_RETURN(announced.header, ReadDracoHeader(source));
  const DracoHeader& header = announced.header;
  CCST_RETURN_IF_ERROR(CheckDracoCounts(header, static_cast<std::size_t>(source.size), limits));
  ByteReader stream(source, static_cast<std::int64_t>(header.data_offset));
  Connectivity(header, stream).Skip();
  ReadAttributes(header, stream, announced.attributes);
  CCST_RETURN_IF_ERROR(stream.status());
  if (stream.failed()) {
    return NotDraco(absl::StrCat("near byte ", stream.position(), " of ", source.size,
                                 ": the connectivity or the table of attributes is damaged"));
  }
  auto& attributes = announced.attributes;
  announced.most_points = header.points;
  if (header.method == DracoMethod::kEdgebreaker) {
    announced.most_points = header.attribute_connectivities > 0
                                ? 3 * header.faces
                                : header.points + header.split_symbols;
  } else if (std::any_of(attributes.begin(), attributes.end(), MaySplit)) {
    for (DracoListedAttribute& attribute : attributes) {
      attribute.has_seams = attribute.type != draco::GeometryAttribute::POSITION;
    }
  }
  return announced;
}

DracoMemory MemoryOf(const DracoAnnouncement& announced) {
  const DracoHeader& header = announced.header;
  const bool is_edgebreaker = header.method == DracoMethod::kEdgebreaker;
  DracoMemory memory;
  memory.decoder_bytes = BaseBytes(header) + kBytesPerPoint * announced.most_points;
  memory.mesh_bytes = kMeshBytesPerFace * header.faces + kMeshBytesPerVertex * header.points;
  const std::int64_t corners = 3 * header.faces;
  for (const DracoListedAttribute& attribute : announced.attributes) {
    const std::int64_t values = attribute.has_seams ? announced.most_points : header.points;
    memory.decoder_bytes += AttributeBytes(attribute, values) +
                            (is_edgebreaker ? kMapBytes * announced.most_points : 0);
    if (!IsCarried(attribute)) continue;
    const std::int64_t row = std::int64_t{sizeof(float)} * attribute.components;
    memory.mesh_bytes += row * (attribute.has_seams ? corners : header.points);
    memory.sample_bytes += row;
  }
  return memory;
}

}  // namespace ccst::io
