// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleSteps_h
#define ParticleSteps_h

#include "vtkPolyDataAlgorithm.h"

#include <string>
#include <vector>

class MessageCapture;
struct Job;

/// The stored steps of a film, for VTK's pipeline: reads the particles of the time that is asked
/// for.
class ParticleSteps : public vtkPolyDataAlgorithm
{
public:
  struct Step
  {
    double Time;
    std::vector<std::string> Files; ///< parts of one set of particles
    std::vector<std::string> Walls; ///< likewise, of walls beside these
  };

  static ParticleSteps* New();
  vtkTypeMacro(ParticleSteps, vtkPolyDataAlgorithm);

  /// Sets the steps, in the order of time. Steps and messages must outlive this.
  void SetSteps(const std::vector<Step>* steps, MessageCapture* messages);

  /// Returns why the last step could not be read, in one sentence; empty if it could.
  const std::string& GetError() const { return this->Error; }
  void ClearError() { this->Error.clear(); }

protected:
  ParticleSteps();
  ~ParticleSteps() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

private:
  ParticleSteps(const ParticleSteps&) = delete;
  void operator=(const ParticleSteps&) = delete;

  const std::vector<Step>* Steps = nullptr;
  MessageCapture* Messages = nullptr;
  std::string Error;
};

/// The first step that is not before this time; there may be none.
std::vector<ParticleSteps::Step>::const_iterator FindStep(
  const std::vector<ParticleSteps::Step>& steps, double time);

/// The steps that the options name. Throws std::runtime_error with one sentence; `warnings` gets
/// others.
std::vector<ParticleSteps::Step> ListSteps(
  const Job& job, MessageCapture* messages, std::vector<std::string>& warnings);

#endif
