#include "app/guide.h"

namespace mocaplm {

namespace {

const char* const kMotion = "Motion";
const char* const kModels = "Models";
const char* const kOther = "Movement without a language model";
const char* const kProgram = "This program";

std::vector<CommandGuide> motion_guides() {
  return {
      {"synth",
       kMotion,
       {{"synth --out dances", "240 dances of ten genres, with labels"},
        {"synth --genres WA,HO --seconds 4 --seed 7 --out short-dances", "fewer and shorter"}}},
      {"import",
       kMotion,
       {{"import mocap/ --out data --label-from-dir genre", "mocap/waack/a.bvh is a waack"},
        {"import mocap/ --out checked --strict --json report.json",
         "or nothing, if one is broken"}}},
      {"info",
       kMotion,
       {{"info clip.bvh", "length, rate, skeleton"},
        {"info dances run waack.json", "a dataset, a training run, an emulator"}}},
      {"tokenize",
       kMotion,
       {{"tokenize dances --out words --text", "the tokenizer, what it loses, and the text"},
        {"tokenize dances --report bins:90 bins:360", "two tokenizers beside each other"}}},
      {"view",
       kMotion,
       {{"view clip.bvh dance.npz --out both.html", "side by side"},
        {"view dance.npz --joints right_arm --title Arm --out arm.html", "the arm in a colour"}}},
      {"convert",
       kMotion,
       {{"convert clip.bvh clip.glb", "a skinned figure for Blender and any viewer"},
        {"convert clip.bvh hero.bvh --skeleton mixamo", "on the joints of a Mixamo character"}}},
      {"render",
       kMotion,
       {{"render clip.bvh --poses 5 --out clip.png", "five poses in one picture"},
        {"render dance.npz:0-1 --out dance.gif --width 320 --height 320", "a film of a second"}}},
  };
}

std::vector<CommandGuide> model_guides() {
  return {
      {"train",
       kModels,
       {{"train --config configs/small.json --data dances --out run", "an hour on two cores"},
        {"train --from run --config configs/finetune.json --data dances --out tuned",
         "goes on with labels as conditions"}}},
      {"generate",
       kModels,
       {{"generate --model run --prompt clip.bvh --joints right_arm,pelvis --out dance",
         "keeps the arm and the pelvis, makes up the rest"},
        {"generate --model tuned --genre waack --seconds 8 --seed 7 --out waack",
         "from nothing but a genre"}}},
      {"evaluate",
       kModels,
       {{"evaluate --model run --data dances --split validation",
         "bits a frame, beside simple baselines"},
        {"evaluate --model run --data dances --forecast --windows 20",
         "forecasts, beside standing still"}}},
      {"classify",
       kModels,
       {{"classify --model run --data dances --labels genre --steps 200 --out classifier",
         "trains one and tests it"},
        {"classify --model classifier clip.bvh dance.npz", "what it says of two clips"}}},
      {"infill",
       kModels,
       {{"infill --model masked clip.bvh --joints left_arm --out armed", "a lost arm"},
        {"infill --model masked clip.bvh --from 1 --to 1.5 --out whole", "a lost half second"}}},
      {"experiment",
       kModels,
       {{"experiment configs/thesis/table-4-4.json --data dances --out table",
         "trains and tests each row"},
        {"experiment configs/thesis/table-4-4.json --data dances --out quick --minutes 0.1",
         "six seconds a row"}}},
      {"demo",
       kModels,
       {{"demo --minutes 0.3 --seconds 4 --out first-look", "every step, a poor dance"},
        {"demo --minutes 0.3 --genre krump --seed 2 --out krump", "another genre"}}},
  };
}

std::vector<CommandGuide> other_guides() {
  return {
      {"query",
       kOther,
       {{"query --index dances clip.bvh", "the dances most like it"},
        {"query --index dances --evaluate genre", "how well neighbours tell the genre"}}},
      {"filter",
       kOther,
       {{"filter clip.bvh --to-hz 2 --out slow", "what is slower than 2 Hz"},
        {"filter clip.bvh --keep band --from-hz 1 --to-hz 4 --out band",
         "what is between 1 and 4 Hz"}}},
      {"interpolate",
       kOther,
       {{"interpolate clip.bvh dance.npz --out between", "half way to the second"},
        {"interpolate clip.bvh dance.npz --target stft --weight 1 --out nearer",
         "all the way, by spectrograms"}}},
      {"emulate",
       kOther,
       {{"emulate fit dances --where genre=waack --out waack.json", "learns how they vary"},
        {"emulate sample waack.json --count 4 --out waack", "makes four new ones"}}},
      {"emulate fit",
       "",
       {{"emulate fit dances --where genre=waack --out waack.json", "of the training split"},
        {"emulate fit dances --where genre=waack --scheme PWI --split all --out pwi.json",
         "pairs, interpolated"}}},
      {"emulate sample",
       "",
       {{"emulate sample waack.json --count 4 --out waack", "motion files and a page"},
        {"emulate sample waack.json --timing mean --seed 3 --out even.bvh", "one file"}}},
      {"emulate test",
       "",
       {{"emulate test dances --label genre --scheme PWI --level-one 0", "of every genre"},
        {"emulate test dances --label genre --scheme PWI --level-one 0 --out report",
         "also a report with plots"}}},
      {"gesture",
       kOther,
       {{"gesture juggle --cycles 20", "the task of the paper"},
        {"gesture fit strokes.csv --out strokes.json", "a model of your own demonstrations"}}},
      {"gesture fit",
       "",
       {{"gesture fit strokes.csv --out strokes.json",
         "from trajectories, a table with a column time"},
        {"gesture fit dances --where genre=waack --joint left_wrist --out wrist.json",
         "the path of a joint"}}},
      {"gesture test",
       "",
       {{"gesture test strokes.csv", "is a linear model enough?"},
        {"gesture test dances --where genre=waack --joint left_wrist --json tables.json",
         "of the path of a joint"}}},
      {"gesture play",
       "",
       {{"gesture play --model strokes.json --out played.csv", "ends and times by chance"},
        {"gesture play --model strokes.json --phase movement --to 0.3,0.2 --out path.csv",
         "to a given place"}}},
      {"gesture juggle",
       "",
       {{"gesture juggle --cycles 20", "a made-up user shows it, a model does it"},
        {"gesture juggle --push 0.05 --cycles 20 --page juggling.html",
         "the hand is pushed on its way"}}},
  };
}

std::vector<CommandGuide> program_guides() {
  return {
      {"doctor",
       kProgram,
       {{"doctor", "what is there, what is missing, how fast it is"},
        {"doctor --json machine.json", "also as a file"}}},
      {"completion",
       kProgram,
       {{"completion bash > mocaplm.bash", "then: source mocaplm.bash"},
        {"completion zsh > _mocaplm", "in a folder of $fpath"}}},
  };
}

}  // namespace

const std::vector<CommandGuide>& command_guides() {
  static const std::vector<CommandGuide> all = [] {
    std::vector<CommandGuide> guides = motion_guides();
    for (const auto& more : {model_guides(), other_guides(), program_guides()})
      guides.insert(guides.end(), more.begin(), more.end());
    return guides;
  }();
  return all;
}

const CommandGuide* guide_of(const std::string& command) {
  for (const CommandGuide& guide : command_guides())
    if (guide.command == command) return &guide;
  return nullptr;
}

const std::vector<Example>& walk_examples() {
  static const std::vector<Example> walk = {
      {"import mocap/ --out data", "motion files become a dataset"},
      {"train --data data --out run", "a model learns its movement"},
      {"generate --model run --out dance", "and dances: .npz, .bvh, a page"},
      {"demo", "all of it on made-up dances"}};
  return walk;
}

void group_commands(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    if (const CommandGuide* guide = guide_of(command->get_name())) command->group(guide->group);
}

}  // namespace mocaplm
