#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gust/nn/actor_network.h"
#include "gust/onnx/data.h"
#include "gust/onnx/program.h"

namespace gust {

/// What a file says about a policy besides its network. Keys of ours: gust.plant, gust.preset, gust.units, gust.seed,
/// gust.version, gust.trial. A foreign file may have none of them, and others.
using OnnxMetadata = std::map<std::string, std::string>;

/// A policy network from an ONNX file. It does not change: any number of threads may share it.
struct OnnxModel {
  OnnxProgram program;
  /// The same network, if it is a chain of linear layers with one kind of activation, and at most a tanh and a box
  /// after them. A risk level has become part of its biases.
  std::optional<ActorNetwork> actor;
  std::optional<float> alpha;  ///< the risk level that it acts at, if the file has an input 'alpha'
  OnnxMetadata metadata;

  std::size_t observations() const { return program.widths[0]; }
  std::size_t actions() const { return program.widths[program.result]; }
};

/// How a file is read.
struct OnnxReading {
  std::optional<float> alpha = {};  ///< the risk level to act at; the file's own if none
  std::string output = {};          ///< the output that is the action; empty: see read_onnx
  const OnnxData* data = nullptr;   ///< the files that onnx_data_files() names
};

/// Reads a feed-forward network of float32 (or float64, which is rounded to it), opset 7 or later, from the bytes of an
/// ONNX file: the part that leads from the one input [N, n] to the action. That is the output that is asked for, else
/// 'action' or 'actions', else 'mu', 'mean' or 'deterministic_continuous_actions', else the only output that is
/// computed from an input. The batch may be open or fixed; the network runs for any number of lanes.
/// onnx_operator_names() is what it may use.
///
/// An input 'alpha' of one number that the file gives a default is a risk level: the model acts at that default, or at
/// the level that is asked for.
///
/// An Error that starts with `name` for everything else: damaged files, weights in a data file that is not given or too
/// short, several outputs that may be the action, operators that are not supported, recurrent networks, shapes that do
/// not fit, numbers that are not finite, files above 64 MiB or 2^24 weights, a level for a file without 'alpha'.
OnnxModel read_onnx(std::string_view bytes, std::string_view name, const OnnxReading& reading = {});

/// The actor as an ONNX file of opset 17: input obs [N, n], output action [N, m], both float32; where it depends on a
/// risk level, a second input alpha [1] with the actor's level as its default. Equal arguments give equal bytes, and
/// read_onnx gives back the same actor to the bit (at its level). A file that is cut short never reads as whole.
std::string write_onnx(const ActorNetwork& actor, const OnnxMetadata& metadata);

/// Runs a model; holds the memory for it. One thread at a time.
class OnnxRunner {
 public:
  /// The model must outlive the runner.
  explicit OnnxRunner(const OnnxModel& model);

  /// From lanes × observations to lanes × actions numbers; those of a lane lie side by side. The bits of a lane depend
  /// neither on the other lanes nor on their number.
  void run(std::span<const float> in, std::size_t lanes, std::span<float> out);

 private:
  static constexpr std::size_t kLanes = 64;

  const OnnxModel& model_;
  std::optional<ActorRunner> actor_;
  std::optional<OnnxProgramRunner> runner_;
};

}  // namespace gust
