// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "pqSPHInUse.h"

#include "pqCoreUtilities.h"
#include "pqProxyWidget.h"
#include "vtkCommand.h"
#include "vtkSMDocumentation.h"
#include "vtkSMDoubleVectorProperty.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyGroup.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

#include <QFormLayout>
#include <QLabel>
#include <QStringList>

namespace
{
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
    if (!property->GetInformationOnly())
    {
      form->addRow(pqProxyWidget::createWidgetForProperty(property, proxy, this));
      continue;
    }
    auto* value = new QLabel(this);
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
  this->showValues();
}

//------------------------------------------------------------------------------
void pqSPHInUse::showValues()
{
  this->proxy()->UpdatePropertyInformation();
  for (const auto& row : this->Rows)
  {
    row.second->setText(textOf(row.first));
  }
}
