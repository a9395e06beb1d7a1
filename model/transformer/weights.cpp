#include "model/transformer/weights.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::vector<std::string> parts;
  for (const std::int64_t extent : shape) parts.push_back(std::to_string(extent));
  return "(" + join(parts, ", ") + ")";
}

bool only_more_rows(const std::vector<std::int64_t>& stored,
                    const std::vector<std::int64_t>& wanted) {
  return !stored.empty() && stored.size() == wanted.size() && stored[0] <= wanted[0] &&
         std::equal(stored.begin() + 1, stored.end(), wanted.begin() + 1);
}

// The name in the file: dots throughout (LibTorch allows none in a parameter's own name).
std::string stored_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

std::vector<float> last_logits(LanguageModel& model, const ModelInput& input) {
  const at::NoGradGuard no_grad;
  const Batch batch = stack({input}).to(model.parameters().front().device());
  const at::Tensor hidden = model.hidden(batch);
  const at::Tensor logits = model.logits(hidden, batch)[0][-1].to(at::kCPU).contiguous();
  return {logits.data_ptr<float>(), logits.data_ptr<float>() + logits.numel()};
}

}  // namespace

TensorMap export_weights(const torch::nn::Module& module) {
  TensorMap tensors;
  for (const auto& item : module.named_parameters()) {
    const at::Tensor value = item.value().detach().to(at::kCPU).contiguous();
    tensors[stored_name(item.key())] = {
        value.sizes().vec(), {value.data_ptr<float>(), value.data_ptr<float>() + value.numel()}};
  }
  return tensors;
}

void import_weights(torch::nn::Module& module, const TensorMap& tensors, const std::string& place,
                    bool may_grow) {
  const at::NoGradGuard no_grad;
  auto parameters = module.named_parameters();
  std::set<std::string> known;
  for (auto& item : parameters) {
    const std::string name = stored_name(item.key());
    known.insert(name);
    const auto found = tensors.find(name);
    if (found == tensors.end())
      throw DataError(in_file(place), "tensor \"" + name + "\" is missing");
    const std::vector<std::int64_t> wanted = item.value().sizes().vec();
    const NamedTensor& stored = found->second;
    if (stored.shape != wanted && !(may_grow && only_more_rows(stored.shape, wanted)))
      throw DataError(in_file(place), "tensor \"" + name + "\" has shape " +
                                          shape_text(stored.shape) + ", the config asks for " +
                                          shape_text(wanted));
    at::Tensor target = item.value();
    if (!stored.shape.empty()) target = target.slice(0, 0, stored.shape[0]);
    target.copy_(at::from_blob(const_cast<float*>(stored.values.data()), stored.shape, at::kFloat));
  }
  for (const auto& [name, tensor] : tensors)
    if (known.count(name) == 0)
      throw DataError(in_file(place), "tensor \"" + name + "\" is not part of this model");
}

std::vector<SelfTestCase> make_self_test(LanguageModel& model,
                                         const std::vector<ModelInput>& inputs) {
  const bool was_training = model.is_training();
  const at::ScalarType precision = model.precision();
  model.eval();
  model.set_precision(at::kFloat);  // what every reader of the model can repeat
  std::vector<SelfTestCase> cases;
  for (const ModelInput& input : inputs) cases.push_back({input, last_logits(model, input)});
  model.set_precision(precision);
  model.train(was_training);
  return cases;
}

std::shared_ptr<LanguageModel> load_transformer(const StoredModel& stored,
                                                const std::string& place) {
  auto model = make_language_model(stored.description);
  import_weights(*model, language_tensors(stored.tensors), place + "/model.safetensors");
  model->eval();
  for (const SelfTestCase& one : stored.self_test) {
    check_input(one.input, stored.description, place + "/selftest.json");
    check_self_test(one, last_logits(*model, one.input), place + "/selftest.json");
  }
  return model;
}

}  // namespace mocaplm
