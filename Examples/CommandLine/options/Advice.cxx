// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "SafeText.h"

namespace
{

struct Advice
{
  const char* Words;
  const char* Instead; ///< where the sentence does not name that option already
  const char* Option;
};

const Advice All[] = {
  { "Turn Estimate Smoothing Length on, or choose Smoothing Length Array",
    "Give --smoothing-length NAME, VALUE or estimate", "--smoothing-length" },
  { "Name its array, give a constant, or have it estimated.",
    "Give --smoothing-length NAME, VALUE or estimate.", "--smoothing-length" },
  { "it is coefh x sqrt(3) x dp.", "it is coefh x sqrt(3) x dp: give --dp and --coefh.", "--dp" },
  { "which its shape cannot have. See mcor_section_shape.",
    "as its file has no triangles; give one of a surface (--flux NAME=FILE).", "--flux" },
  { "Choose Velocity Array", "Give --velocity NAME", "--velocity" },
  { "Name the array of ids", "Name the array of ids (--ids NAME)", "--ids" },
  { "arger cube size", "arger cube size (--cube-size)", "--cube-size" },
  { "maller cube size", "maller cube size (--cube-size)", "--cube-size" },
  { "another cube size", "another cube size (--cube-size)", "--cube-size" },
  { "a cube size of no more", "a cube size (--cube-size) of no more", "--cube-size" },
  { "fewer levels", "fewer levels (--max-level)", "--max-level" },
  { "complete seeds", "complete seeds (--seeds complete)", "--seeds" },
  { "uniform cubes", "uniform cubes (--cubes uniform)", "--cubes" },
  { "lacks. Turn one of them off",
    "lacks. Turn one of them off (leave out --filled, or --compact and --smooth)", "--compact" },
  { "box. Turn one of them off", "box. Turn one of them off (leave out --filled or --capping)",
    "--capping" },
  { "urn filling off", "urn filling off (leave out --filled)", "--filled" },
  { "urn capping off", "urn capping off (leave out --capping)", "--capping" },
  { "set the dimension to 3", "set the dimension to 3 (--dimension 3)", "--dimension" },
  { "use three dimensions", "use three dimensions (--dimension 3)", "--dimension" },
  { "Set Output Points Precision to Double", "Give --output-precision double",
    "--output-precision" },
  { "Try double precision", "Try double precision (--precision double)", "--precision" },
  { "hoose another device", "hoose another device (--device)", "--device" },
  { "se single precision", "se single precision (--precision single)", "--precision" },
  { "or single precision", "or single precision (--precision single)", "--precision" },
  { "a higher memory limit", "a higher memory limit (--memory-limit)", "--memory-limit" },
  { "a higher iteration limit", "a higher iteration limit (--iteration-limit)",
    "--iteration-limit" },
  { "a larger tolerance", "a larger tolerance (--tolerance)", "--tolerance" },
  { "choose a larger factor", "choose a larger factor (--h-scale)", "--h-scale" },
  { "masses and densities, or remove",
    "masses and densities (--volume, or --mass and --density), or remove", "--volume" },
  { "there is an option for that", "there is an option for that: --support-radius",
    "--support-radius" },
  { "Use a node threshold", "Use a node threshold (--node-threshold)", "--node-threshold" },
  { "use the sum as the field, and 0 as the node threshold and the vertex threshold",
    "use --field sum --node-threshold 0 --vertex-threshold 0", "--field" },
  { "use the sum as the field, and thresholds of 0",
    "use --field sum --node-threshold 0 --vertex-threshold 0", "--field" },
  { "with the value of the fluid", "with the value of the fluid (--fluid NAME=VALUE)", "--fluid" },
  { "pthread_create has failed: Resource temporarily unavailable",
    "no thread can be started; raise the limit of processes (ulimit -u)", "ulimit -u" },
  { "by a range of positions", "by a range of positions (--within)", "--within" },
  { "Set the periodic bounds", "Set the periodic bounds (--periodic)", "--periodic" },
};
}

std::string Reworded(
  const std::string& sentence, const std::string& words, const std::string& instead)
{
  const std::size_t at = sentence.find(words);
  return at == std::string::npos ? sentence
                                 : std::string(sentence).replace(at, words.size(), instead);
}

std::string WithOptions(const std::string& sentence)
{
  std::string result = sentence;
  for (const Advice& advice : All)
  {
    if (result.find(advice.Option) == std::string::npos)
    {
      result = Reworded(result, advice.Words, advice.Instead);
    }
  }
  return result;
}
