#ifndef DEPTHFARM_WORKER_ESTIMATION_LABEL_FIELD_CODEC_H_
#define DEPTHFARM_WORKER_ESTIMATION_LABEL_FIELD_CODEC_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "worker/estimation/label_field.h"

namespace depthfarm {

// A label field as an artifact: versioned header, levels delta-coded, zstd with content checksum. Same field, same
// bytes.
[[nodiscard]] std::string EncodeLabelField(const LabelField& field);

// kCorrupt, with the reason, for anything EncodeLabelField does not write, kIncompatible for another version; bounded
// allocation on hostile input.
[[nodiscard]] Result<LabelField> DecodeLabelField(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ESTIMATION_LABEL_FIELD_CODEC_H_
