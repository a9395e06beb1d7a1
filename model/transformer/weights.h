// Between the trainable transformer and the model directory.
#pragma once

#include <memory>

#include "model/directory.h"
#include "model/transformer/language_model.h"

namespace mocaplm {

TensorMap export_weights(const torch::nn::Module& module);

// Copies tensors by name. With `may_grow`, a parameter may have more rows than the stored tensor
// (label tokens added for fine-tuning): the extra rows keep their fresh values. Throws DataError
// naming the tensor that is missing, unknown or of another shape.
void import_weights(torch::nn::Module& module, const TensorMap& tensors, const std::string& place,
                    bool may_grow = false);

// The model with the stored weights, after rerunning the stored self-test on the CPU in f32.
std::shared_ptr<LanguageModel> load_transformer(const StoredModel& stored,
                                                const std::string& place);

// A few windows with the logits that this model gives for them now.
std::vector<SelfTestCase> make_self_test(LanguageModel& model,
                                         const std::vector<ModelInput>& inputs);

}  // namespace mocaplm
