// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "pqSPHInUse.h"

#include "pqCoreUtilities.h"
#include "pqProxyWidget.h"
#include "pqUndoStack.h"
#include "vtkCommand.h"
#include "vtkSMDocumentation.h"
#include "vtkSMDoubleVectorProperty.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyGroup.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSmartPointer.h"

#include <QFormLayout>
#include <QLabel>
#include <QStringList>

namespace
{
// As of the filter's own warning, which comes when the run has begun.
constexpr double HUGE_CELLS = 1e9;

// What the next update's range and number of cells depend on.
const char* const CHOICES[] = { "FreeSurface", "SelectInputScalars", "ScalarComponent",
  "DotProductWith", "SmoothingLengthArray", "SmoothingLength", "EstimateSmoothingLength",
  "SmoothingLengthIsSupportRadius", "FluidArray", "FluidValue", "Kernel", "CubeSizeMode",
  "CubeLevelLimit", "CubeSizeFactor", "CubeSize", "UseBox", "BoxPosition", "BoxLength" };

// "-" for what is not known: nothing was drawn, or the free surface has no such thing.
QString textOf(vtkSMProperty* property)
{
  const vtkSMPropertyHelper values(property, true);
  const bool isNumber = vtkSMDoubleVectorProperty::SafeDownCast(property) != nullptr;
  QStringList texts;
  bool isKnown = false;
  for (unsigned int i = 0; i < values.GetNumberOfElements(); ++i)
  {
    texts << (isNumber ? QString::number(values.GetAsDouble(i))
                       : QString::fromUtf8(values.GetAsString(i)));
    isKnown = isKnown || (isNumber ? values.GetAsDouble(i) != 0.0 : !texts.back().isEmpty());
  }
  return isKnown ? texts.join(" to ") : QString("-");
}

bool isHuge(vtkSMProperty* property)
{
  return QLatin1String(property->GetXMLName()) == QLatin1String("NextCells") &&
    vtkSMPropertyHelper(property, true).GetAsDouble() >= HUGE_CELLS;
}

// A filter like this one that nobody sees, with what the panel shows, applied or not.
vtkSmartPointer<vtkSMProxy> makeTwin(vtkSMProxy* filter)
{
  auto twin = vtkSmartPointer<vtkSMProxy>::Take(
    filter->GetSessionProxyManager()->NewProxy(filter->GetXMLGroup(), filter->GetXMLName()));
  if (twin)
  {
    const vtkSMPropertyHelper input(filter, "Input");
    vtkSMPropertyHelper(twin, "Input").Set(input.GetAsProxy(), input.GetOutputPort());
    for (const char* name : CHOICES)
    {
      vtkSMPropertyHelper shown(filter, name);
      shown.SetUseUnchecked(true);
      vtkSMPropertyHelper(twin, name).Copy(shown);
    }
    twin->UpdateVTKObjects();
  }
  return twin;
}
}

//------------------------------------------------------------------------------
pqSPHInUse::pqSPHInUse(vtkSMProxy* proxy, vtkSMPropertyGroup* group, QWidget* parent)
  : pqPropertyWidget(proxy, parent)
{
  this->setShowLabel(true); // the group's, as a heading
  auto* form = new QFormLayout(this);
  form->setContentsMargins(0, 0, 0, 0);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  for (unsigned int i = 0; i < group->GetNumberOfProperties(); ++i)
  {
    vtkSMProperty* property = group->GetProperty(i);
    if (QLatin1String(property->GetXMLName()) == QLatin1String("NextScalarRange"))
    {
      continue; // the list of iso values shows it, as its domain
    }
    if (!property->GetInformationOnly())
    {
      form->addRow(pqProxyWidget::createWidgetForProperty(property, proxy, this));
      continue;
    }
    auto* value = new QLabel(this);
    value->setObjectName(property->GetXMLName());
    value->setWordWrap(true);
    value->setTextInteractionFlags(Qt::TextSelectableByMouse);
    if (vtkSMDocumentation* documentation = property->GetDocumentation())
    {
      value->setToolTip(QString::fromUtf8(documentation->GetDescription()).simplified());
    }
    form->addRow(QString::fromUtf8(property->GetXMLLabel()) + ":", value);
    this->Rows << qMakePair(property, value);
  }
  pqCoreUtilities::connect(proxy, vtkCommand::UpdateDataEvent, this, SLOT(showValues()));
  this->Pause.setSingleShot(true);
  this->Pause.setInterval(200);
  this->connect(&this->Pause, SIGNAL(timeout()), SLOT(lookAhead()));
  for (const char* name : CHOICES)
  {
    pqCoreUtilities::connect(proxy->GetProperty(name), vtkCommand::UncheckedPropertyModifiedEvent,
      &this->Pause, SLOT(start()));
  }
  this->showValues();
}

//------------------------------------------------------------------------------
void pqSPHInUse::showValues()
{
  this->Pause.stop();
  this->proxy()->UpdatePropertyInformation();
  this->showRows();
}

//------------------------------------------------------------------------------
// The range is the domain of the list of iso values, which shows it and follows it.
void pqSPHInUse::lookAhead()
{
  SCOPED_UNDO_EXCLUDE(); // nothing that a user did
  const vtkSmartPointer<vtkSMProxy> twin = makeTwin(this->proxy());
  if (!twin)
  {
    return;
  }
  for (const char* name : { "NextScalarRange", "NextCells" })
  {
    twin->UpdatePropertyInformation(twin->GetProperty(name));
    vtkSMPropertyHelper(this->proxy(), name).Copy(vtkSMPropertyHelper(twin, name));
  }
  this->showRows();
}

//------------------------------------------------------------------------------
void pqSPHInUse::showRows()
{
  for (const auto& row : this->Rows)
  {
    const bool huge = isHuge(row.first);
    row.second->setText(
      textOf(row.first) + (huge ? ": this may take minutes and much memory" : ""));
    row.second->setStyleSheet(huge ? "color: #c00000; font-weight: bold" : "");
  }
}
