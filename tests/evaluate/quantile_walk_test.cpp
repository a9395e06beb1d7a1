// Quantile bins from end to end: a small model is trained, generates and is evaluated.
#include <gtest/gtest.h>

#include "common/temporary_folder.h"
#include "evaluate/evaluate.h"
#include "generate/generator.h"
#include "model/transformer/weights.h"
#include "motion/synth.h"
#include "train/trainer.h"

namespace mocaplm::quantile_walk_test {

namespace {

TEST(QuantileWalk, AModelOfQuantileBinsTrainsGeneratesAndIsEvaluated) {
  TemporaryFolder folder;
  SynthConfig dances;
  dances.genres = {"WA", "LO"};
  dances.choreographies = 2;
  dances.seconds = 6;
  write_dances(dances, folder / "dances", false, 0);
  for (const char* binning : {"quantile", "pooled_quantile"}) {
    TrainOptions options;
    options.config.tokenizer.bins = 90;
    options.config.tokenizer.binning = binning;
    options.config.tokenizer.joints = {"left_shoulder", "right_knee"};
    options.config.model.n_layer = 1;
    options.config.model.n_head = 2;
    options.config.model.n_embd = 48;
    options.config.model.block_size = 128;
    options.config.model.dropout = 0;
    options.config.train.steps = 80;
    options.config.train.batch_size = options.config.train.micro_batch = 8;
    options.config.train.warmup = 10;
    options.config.train.learning_rate = 3e-3;
    options.config.train.validate_every = 40;
    options.config.train.conditions = {"none"};
    options.data = folder / "dances";
    options.out = folder / (std::string("run-") + binning);
    options.device = "cpu";
    options.threads = 1;
    train(options);

    Generator generator(load_model(options.out), "run");
    EXPECT_EQ(generator.tokenizer().config().binning, binning);
    GenerateRequest request;
    request.seconds = 4;
    const GenerateResult dance = generator.generate(request);
    EXPECT_EQ(dance.clip.frames(), 80);
    EXPECT_NO_THROW(check_clip(dance.clip, "generated"));
    // Also bins that a channel does not have, which a model may say, mean poses that were fitted.
    const Tokenizer& tokenizer = generator.tokenizer();
    for (Eigen::Index t = 0; t < dance.clip.frames(); ++t)
      for (int c = 0; c < tokenizer.rotation_channels(); ++c) {
        const double value = dance.clip.poses(t, 3 * tokenizer.channel_joint(c) + c % 3);
        EXPECT_EQ(tokenizer.beyond(c, value), 0) << t << " " << c;
      }

    EvaluateOptions evaluate;
    evaluate.model = options.out;
    evaluate.data = folder / "dances";
    evaluate.device = "cpu";
    evaluate.threads = 1;
    const BitColumns bits = split_bits(evaluate).groups.at("");
    const int channels = tokenizer.channels();
    const double model = bits.model.per_frame(0, channels),
                 histogram = bits.orders[0].per_frame(0, channels);
    EXPECT_GT(model, 0);
    EXPECT_LT(model, 0.8 * histogram) << binning << ": better than each channel's histogram";
  }
}

}  // namespace

}  // namespace mocaplm::quantile_walk_test
